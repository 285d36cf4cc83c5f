// SPDX-License-Identifier: MIT
// What each command of the program does. Each returns the exit code: 0 ok; 1 the reply or a file has errors;
// 2 wrong use; 3 no daemon there; 4 the run ended but a body was frozen, a controller failed or the recording
// did; 5 the run was cut short before its duration.
#pragma once

#include "server/app/options.h"

namespace coopdyn {

inline constexpr int kExitOk = 0, kExitErrors = 1, kExitWrongUse = 2, kExitNoDaemon = 3, kExitFaulty = 4,
                     kExitCutShort = 5;

int Serve(ServeOptions options);
int Check(const CheckOptions& options);
int Remote(const RemoteOptions& options);
int Doctor(const RemoteOptions& options);

}  // namespace coopdyn
