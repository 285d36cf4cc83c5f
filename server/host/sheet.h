// SPDX-License-Identifier: MIT
// The sheet that a teacher prints and cuts up: for each student name, PIN, personal link and the link as a QR
// code. Pure; any thread.
#pragma once

#include <string>

#include "server/host/roll.h"

namespace coopdyn {

/// A page without other files. `url`: of the class, with its last '/'.
std::string SheetPage(const Roll& roll, const std::string& url);

/// `text` as a QR code, an <svg> element; empty if it is too long (about 2,900 bytes).
std::string QrSvg(const std::string& text);

}  // namespace coopdyn
