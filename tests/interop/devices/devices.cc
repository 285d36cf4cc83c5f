// SPDX-License-Identifier: MIT
// Usage: devices SECTION [SECONDS]
// Opens the devices of a daemon that runs devices.scenario like programs of YARP 3.12 or 4 do, and checks
// their data. Prints a line for each check, then `N passed, N failed`. tests/interop/yarp builds and runs it.
#include <yarp/os/Network.h>

#include <cstdio>
#include <cstdlib>
#include <string>

#include "sections.h"

int main(int count, char** words) {
  const std::string section = count > 1 ? words[1] : "";
  const double seconds = count > 2 ? std::atof(words[2]) : 5;
  yarp::os::Network network;
  if (!yarp::os::Network::checkNetwork(5)) {
    std::printf("there is no name server: yarp conf HOST PORT\n");
    return 2;
  }
  coopdyn::Checks checks;
  if (section == "board") {
    CheckBoard(checks);
  } else if (section == "forces") {
    CheckForces(checks);
  } else if (section == "sensors") {
    CheckSensors(checks);
  } else if (section == "sweep") {
    CheckSweep(checks);
  } else if (section == "clock" && seconds > 0) {
    CheckClock(checks, seconds);
  } else if (section == "lockstep" && seconds > 0) {
    CheckLockstep(checks, seconds);
  } else {
    std::printf("the sections are board, forces, sensors, sweep, clock SECONDS and lockstep SECONDS\n");
    return 2;
  }
  return checks.Finish();
}
