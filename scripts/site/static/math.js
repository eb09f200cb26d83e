// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
"use strict";
document.addEventListener("DOMContentLoaded", () => {
  for (const element of document.querySelectorAll(".katex-source")) {
    const displayMode = element.classList.contains("katex-block");
    katex.render(element.textContent, element, {displayMode, throwOnError: false});
  }
});
