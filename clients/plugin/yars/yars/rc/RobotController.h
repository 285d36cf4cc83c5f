// SPDX-License-Identifier: MIT
#pragma once

#include "yars/rc/RobotController.hpp"
