# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
"""IMU preintegration and the sliding window."""

import os
import pathlib

import numpy as np
import pytest

import glissade as gl

FLIGHT = pathlib.Path(os.environ.get("GLISSADE_SOURCE", pathlib.Path(__file__).parents[2])) / "data" / "flight"


def rest(n=201):
    return np.arange(n) * 5_000_000, np.zeros((n, 3)), np.tile([0.0, 0.0, 9.81], (n, 1))


def test_preintegration_at_rest_and_its_edge():
    interval = gl.preintegrate(*rest())
    assert interval.dt == pytest.approx(1.0)
    np.testing.assert_allclose(interval.dv, [0, 0, 9.81], atol=1e-12)
    np.testing.assert_allclose(interval.dq, [0, 0, 0, 1], atol=1e-15)
    assert interval.covariance.shape == (15, 15) and interval.num_gaps == 0
    pose, speed_bias = interval.predict([0, 0, 0, 0, 0, 0, 1], np.zeros(9))
    np.testing.assert_allclose(pose, [0, 0, 0, 0, 0, 0, 1], atol=1e-12)
    np.testing.assert_allclose(speed_bias, np.zeros(9), atol=1e-12)
    problem = gl.Problem()
    poses = problem.add_poses([[0, 0, 0, 0, 0, 0, 1], [0.3, 0, 0.1, 0, 0, 0, 1]])
    speeds = problem.add_speed_biases(np.zeros((2, 9)))
    problem.add_imu(poses[0], speeds[0], poses[1], speeds[1], [interval])
    problem.add_speed_bias_priors(speeds[0], np.zeros(9), sqrt_information=100.0)
    problem.fix(poses[0])
    assert problem.solve().converged
    np.testing.assert_allclose(problem.values(poses[1])[0, :3], 0.0, atol=1e-6)
    with pytest.raises(gl.Error):
        gl.preintegrate([0, 0], np.zeros((2, 3)), np.zeros((2, 3)))
    with pytest.raises(ValueError, match="gyro has 1 rows where 2 are needed"):
        gl.preintegrate([0, 1], np.zeros(3), np.zeros((2, 3)))


def test_buffer_interpolates_and_refuses():
    buffer = gl.ImuBuffer()
    buffer.add(*rest())
    stamps, gyro, accel = buffer.between(2_000_000, 7_000_000)
    assert list(stamps) == [2_000_000, 5_000_000, 7_000_000] and gyro.shape == (3, 3)
    with pytest.raises(gl.Error) as error:
        buffer.between(0, 10**12)
    assert error.value.code == gl.StatusCode.INVALID_ARGUMENT
    with pytest.raises(gl.Error) as error:
        buffer.add([1_000_000_000], [[0, 0, 0]], [[0, 0, 0]])
    assert error.value.code == gl.StatusCode.DUPLICATE
    assert len(buffer) == 201
    assert buffer.preintegrate(0, 10_000_000).dt == pytest.approx(0.01)


def test_a_recording_through_a_window():
    if not FLIGHT.is_dir():
        pytest.skip(f"no recording at {FLIGHT}")
    recording = gl.read_viotracks(str(FLIGHT))
    window = gl.SlidingWindow(recording.options())
    stamps, poses = gl.replay(recording, window)
    assert window.running and len(stamps) > 50
    errors = gl.evaluate_trajectory(stamps, poses, *recording.ground_truth)
    assert errors["translation_m"]["rmse"] < 0.3
    assert window.covariance().shape == (15, 15)
    assert window.points.shape[1] == 3 and len(window.poses) >= 3
    assert window.events()["keyframe"] > 0
    # By hand, frame by frame: the same bits.
    again = gl.SlidingWindow(recording.options())
    imu_stamps, gyro, accel = recording.imu
    begin = 0
    by_hand = []
    for k, stamp in enumerate(recording.frame_stamps_ns):
        end = min(int(np.searchsorted(imu_stamps, stamp, side="left")) + 1, len(imu_stamps))
        if end > begin:
            again.add_imu(imu_stamps[begin:end], gyro[begin:end], accel[begin:end])
            begin = end
        again.add_frame(int(stamp), *recording.observations(k))
        again.optimize()
        if again.running:
            by_hand.append(again.newest.pose)
    np.testing.assert_array_equal(np.array(by_hand), poses)


def test_what_a_window_refuses():
    options = gl.SlidingWindowOptions()
    with pytest.raises(gl.Error):
        gl.SlidingWindow(options)
    options.cameras = [gl.WindowCamera(460, 460, 320, 240)]
    options.imu_noise = gl.ImuNoise()
    options.policy = gl.FixedLagPolicy(2.0)
    window = gl.SlidingWindow(options)
    with pytest.raises(ValueError, match="uv has 1 rows where 2 are needed"):
        window.add_frame(0, [1, 2], [[3.0, 4.0]])
    window.start(0, [0, 0, 0, 0, 0, 0, 1], np.zeros(9))
    assert window.running and window.phase == gl.WindowPhase.RUNNING
    with pytest.raises(gl.Error):
        window.start(0, [0, 0, 0, 0, 0, 0, 1], np.zeros(9))
    with pytest.raises(gl.Error):
        window.add_frame(1_000_000, [1], [[3.0, 4.0]])  # the IMU is not there yet
