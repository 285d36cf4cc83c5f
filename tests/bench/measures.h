// SPDX-License-Identifier: MIT
// Measuring functions of the benchmarks. Any thread.
#pragma once

#include <sys/types.h>

#include <vector>

namespace coopdyn {

/// For an even number of values the mean of the middle two; 0 for none.
double Median(std::vector<double> values);
/// User and system time of all threads of this process, s.
double OwnCpu_s();
/// CPU time of all threads of a process, s.
double CpuOf_s(pid_t pid);
/// Memory of this process that is in RAM.
double Resident_kb();

}  // namespace coopdyn
