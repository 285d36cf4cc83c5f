// SPDX-License-Identifier: MIT
// The robots that a client means by names of robots and of swarms. Pure; any thread.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "server/state/scene.h"

namespace coopdyn {

struct NamedRobots {
  std::vector<int> robots;  // indices into the scene, increasing, each once
  std::string error;        // for error 10: a word that is neither; empty: none
};

/// Words of `text`: a robot's name, or the NAME of a [SWARM_n], or `swarm1` for [SWARM_1]; in a scenario no
/// two are called the same. A leading / is dropped.
NamedRobots FindNamedRobots(const Scene& scene, std::string_view text);

}  // namespace coopdyn
