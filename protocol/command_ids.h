// SPDX-License-Identifier: MIT
// Numbers of all commands. docs/protocol.md lists their params and data.
#pragma once

#include <cstdint>

namespace coopdyn::command {

using Id = std::int32_t;

// Unsolicited messages. A pushed reading has its get-command's number, negated.
inline constexpr Id kClosing = -1;
inline constexpr Id kUnreadable = -2;

// Every module.
inline constexpr Id kPing = 0, kDescribe = 1, kReady = 2, kGetTime = 3, kSubscribe = 4, kUnsubscribe = 5,
                    kHello = 6, kClaim = 7, kRelease = 8, kAttach = 9;
// /R/motors
inline constexpr Id kSetWheelSpeeds = 10, kSetVelocity = 11, kGetWheels = 12, kGetLimits = 13, kStop = 14;
// /R/distance
inline constexpr Id kGetDistances = 20, kGetGeometry = 21;
// /R/target
inline constexpr Id kGetTargets = 30, kGetTarget = 31, kGetRobots = 32;
// /R/pose
inline constexpr Id kGetPose = 40, kGetPose3d = 41;
// /R/neighbours
inline constexpr Id kGetNeighbours = 200, kSendMessage = 201, kGetMessages = 202, kGetLink = 199;
// /R/imu, /R/wrench
inline constexpr Id kGetImu = 230, kGetWrench = 240;
// /R/lidar
inline constexpr Id kGetScan = 250, kGetScanGeometry = 251;
// /R/contact
inline constexpr Id kGetContacts = 260, kGetBumper = 261;
// /R/camera
inline constexpr Id kGetImage = 270, kGetCamera = 271;
// /R/support
inline constexpr Id kGetSupport = 280;
// /R/battery
inline constexpr Id kGetBattery = 290;
// /R/compass
inline constexpr Id kGetCompass = 300;
// /R/light, /R/sonar, /R/infrared, /R/odometry
inline constexpr Id kGetLight = 310, kGetSonar = 320, kGetInfrared = 330, kGetOdometry = 340;
// /R/channel
inline constexpr Id kGetValues = 350, kSetMotors = 351, kGetChannel = 352;
// Control boards: /R/joints
inline constexpr Id kGetJoints = 203, kSetPositions = 204, kSetPositionsDirect = 205, kSetVelocities = 206,
                    kSetEfforts = 207, kSetModes = 208, kGetModes = 209, kSetCompliance = 210,
                    kGetCompliance = 211, kSetProfile = 212, kGetProfile = 213, kSetGains = 214,
                    kGetGains = 215, kGetJointLimits = 216, kGetMotion = 217, kGetReferences = 218,
                    kHold = 219, kGetChain = 220, kGetBoard = 221, kSetPwm = 222, kGetDriveTrains = 223;
// /R/muscles
inline constexpr Id kSetActivations = 224, kGetMuscles = 225, kGetMuscleLimits = 226;
// /R/thrusters
inline constexpr Id kSetThrusts = 227, kGetThrusts = 228, kGetThrusterLimits = 229;
// /swarm
inline constexpr Id kStepAll = 110, kSelectReadings = 111, kReadAll = 112, kGetTeam = 113, kStopTeam = 114;
// /simulation
inline constexpr Id kGetStatus = 100, kRun = 101, kPause = 102, kStep = 103, kReset = 104, kSetMode = 105,
                    kSetStep = 106, kSetSpeed = 107, kLoadScenario = 108, kQuit = 109, kStopAll = 190,
                    kSetParticipants = 191, kReload = 192, kReleaseRobot = 193, kSaveState = 194,
                    kRestoreState = 195, kGetSaved = 196, kLog = 197, kEndRun = 198, kGetClock = 189;
// /world
inline constexpr Id kInsert = 140, kRemove = 141, kSetPose = 142, kSetThing = 143, kRename = 144,
                    kListWorld = 145, kSaveWorld = 146, kUndo = 147, kRedo = 148, kPick = 149,
                    kGetWorld = 150;
// /recorder
inline constexpr Id kGetRecording = 120, kStartRecording = 121, kStopRecording = 122, kNote = 123,
                    kListRuns = 124, kDeleteRun = 125, kRenameRun = 126;
// /playback
inline constexpr Id kGetPlayback = 130, kSeek = 131, kPlay = 132, kPausePlayback = 133, kSetPlaySpeed = 134,
                    kSkip = 135, kSetLoop = 136, kBranch = 137, kOpenRecording = 138, kCloseRecording = 139;

}  // namespace coopdyn::command
