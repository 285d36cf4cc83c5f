// SPDX-License-Identifier: MIT
// Numbers of the protocol, and how long the client waits for an answer.
#pragma once

namespace coopdyn::client {

/// Error codes that this library acts on.
inline constexpr int kNotPossible = 5, kOwned = 6, kNoSuchName = 10, kTimedOut = 11;
inline constexpr const char* kLoad = "load";                    // what an error says that ends a wait
inline constexpr const char* kPlaying = "playing a recording";  // how an error begins

inline constexpr int kLockstep = 1;  // a mode

inline constexpr double kRequestTimeout_s = 10;  // for what is answered at once
inline constexpr double kLoadTimeout_s = 60;     // for what builds a world or closes a file
inline constexpr double kFarewell_s = 0.2;       // for the daemon to read what is sent last

}  // namespace coopdyn::client
