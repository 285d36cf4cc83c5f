// SPDX-License-Identifier: MIT
// LimitWheels() and WheelsFor(): they live in the model, since loaded controllers need them too.
#pragma once

#include "server/model/drive.h"
