# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
"""Grey images of 8 bits in plain Python: reading and writing PNG, and what tests ask of one."""

import math
import pathlib
import struct
import zlib


class GreyImage:
    """rows[y][x], 0 to 255."""

    def __init__(self, rows):
        self.rows = rows
        self.height, self.width = len(rows), len(rows[0])

    @staticmethod
    def read(path):
        data = pathlib.Path(path).read_bytes()
        assert data[:8] == b"\x89PNG\r\n\x1a\n", path
        at, packed, header = 8, b"", None
        while at < len(data):
            size, kind = struct.unpack(">I4s", data[at:at + 8])
            if kind == b"IHDR":
                header = struct.unpack(">IIBBBBB", data[at + 8:at + 21])
            if kind == b"IDAT":
                packed += data[at + 8:at + 8 + size]
            at += 12 + size
        width, height, *rest = header
        assert rest == [8, 0, 0, 0, 0], (path, rest)  # grey, 8 bits, not interlaced
        flat, rows, above = zlib.decompress(packed), [], bytearray(width)
        for y in range(height):
            kind, *row = flat[y * (width + 1):(y + 1) * (width + 1)]
            for x in range(width):
                left, corner = (row[x - 1], above[x - 1]) if x > 0 else (0, 0)
                row[x] = (row[x] + predicted(kind, left, above[x], corner)) & 255
            above = row
            rows.append(row)
        return GreyImage(rows)

    def write(self, path):
        def chunk(kind, body):
            return (struct.pack(">I", len(body)) + kind + body +
                    struct.pack(">I", zlib.crc32(kind + body)))
        body = b"".join(b"\0" + bytes(row) for row in self.rows)
        pathlib.Path(path).write_bytes(
            b"\x89PNG\r\n\x1a\n" +
            chunk(b"IHDR", struct.pack(">IIBBBBB", self.width, self.height, 8, 0, 0, 0, 0)) +
            chunk(b"IDAT", zlib.compress(body)) + chunk(b"IEND", b""))

    def mean(self):
        return sum(map(sum, self.rows)) / (self.width * self.height)

    def gradient(self):
        """Mean absolute difference to the pixel on the right."""
        total = sum(abs(a - b) for row in self.rows for a, b in zip(row, row[1:]))
        return total / (self.height * (self.width - 1))

    def at(self, x, y):
        """Bilinear; pixels have their centres at whole numbers."""
        i, j = int(x), int(y)
        s, t = x - i, y - j
        r, q = self.rows[j], self.rows[j + 1]
        return (1 - t) * ((1 - s) * r[i] + s * r[i + 1]) + t * ((1 - s) * q[i] + s * q[i + 1])

    def patch(self, x, y, half):
        """Around a place; None where it does not lie in the image."""
        inside = half < x < self.width - 2 - half and half < y < self.height - 2 - half
        return [self.at(x + i, y + j) for j in range(-half, half + 1)
                for i in range(-half, half + 1)] if inside else None


def predicted(kind, left, up, corner):
    """Of PNG's filters: nothing, the left, the upper one, their mean, Paeth's."""
    if kind < 4:
        return (0, left, up, (left + up) // 2)[kind]
    guess = left + up - corner
    return min((left, up, corner), key=lambda value: abs(guess - value))


def spread(values):
    """Standard deviation."""
    mean = sum(values) / len(values)
    return math.sqrt(sum((v - mean) ** 2 for v in values) / len(values))


def correlation(a, b):
    """Normalized, of two lists of the same length."""
    ma, mb = sum(a) / len(a), sum(b) / len(b)
    ab = sum((x - ma) * (y - mb) for x, y in zip(a, b))
    return ab / (len(a) * max(spread(a) * spread(b), 1e-9))
