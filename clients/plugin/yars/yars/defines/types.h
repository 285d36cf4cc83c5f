// SPDX-License-Identifier: MIT
// For sources written for YARS.
#pragma once

using uint = unsigned int;
