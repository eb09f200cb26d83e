// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// Whether matrices that the library fills are sound in this program's hands.
bool MatricesAreSound();
