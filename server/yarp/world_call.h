// SPDX-License-Identifier: MIT
// The calls of the world interface, and the parsing of requests. Pure functions; any thread.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "server/yarp/bottle.h"

namespace coopdyn {

// From kGravity on they need the current world.
enum class WorldAct {
  kRefuse,
  kMake,
  kLoad,
  kColor,
  kMove,
  kDelete,
  kRename,
  kGravity,
  kCollision,
  kPose,
  kDeleteAll,
  kList
};
enum class WorldReply { kDone, kName, kPose, kNames };

struct WorldCall {
  std::string_view name;
  WorldAct act;
  WorldReply reply;
  std::string_view parts;       // arguments; optional ones in brackets
  std::string_view thing = {};  // the kind of thing to make; for kRefuse the reason
};
inline constexpr const char* kNoFrame =
    "a frame without a body cannot stand here: make a thing, or insert a target through /world";
inline constexpr const char* kNoGlue = "nothing can be glued to a robot here: it carries what it touches";
inline constexpr WorldCall kWorldCalls[] = {
    {"makeSphere", WorldAct::kMake, WorldReply::kName,
     "RADIUS X Y Z ROLL PITCH YAW RED GREEN BLUE [FRAME] [NAME] [GRAVITY] [COLLISION]", "sphere"},
    {"makeBox", WorldAct::kMake, WorldReply::kName,
     "WIDTH HEIGHT THICKNESS X Y Z ROLL PITCH YAW RED GREEN BLUE [FRAME] [NAME] [GRAVITY] [COLLISION]",
     "box"},
    {"makeCylinder", WorldAct::kMake, WorldReply::kName,
     "RADIUS LENGTH X Y Z ROLL PITCH YAW RED GREEN BLUE [FRAME] [NAME] [GRAVITY] [COLLISION]", "cylinder"},
    {"makeFrame", WorldAct::kRefuse, WorldReply::kName,
     "SIZE X Y Z ROLL PITCH YAW RED GREEN BLUE [FRAME] [NAME] [GRAVITY] [COLLISION]", kNoFrame},
    {"changeColor", WorldAct::kColor, WorldReply::kDone, "ID RED GREEN BLUE"},
    {"setPose", WorldAct::kMove, WorldReply::kDone, "ID X Y Z ROLL PITCH YAW [FRAME]"},
    {"enableGravity", WorldAct::kGravity, WorldReply::kDone, "ID ON"},
    {"enableCollision", WorldAct::kCollision, WorldReply::kDone, "ID ON"},
    {"getPose", WorldAct::kPose, WorldReply::kPose, "ID [FRAME]"},
    {"loadModelFromFile", WorldAct::kLoad, WorldReply::kDone, "MODEL"},
    {"loadModelFromFileWithPose", WorldAct::kLoad, WorldReply::kName,
     "MODEL X Y Z ROLL PITCH YAW [NAME] [TIMEOUT]"},
    {"deleteObject", WorldAct::kDelete, WorldReply::kDone, "ID"},
    {"deleteAll", WorldAct::kDeleteAll, WorldReply::kDone, ""},
    {"getList", WorldAct::kList, WorldReply::kNames, ""},
    {"attach", WorldAct::kRefuse, WorldReply::kDone, "ID LINK", kNoGlue},
    {"detach", WorldAct::kRefuse, WorldReply::kDone, "ID", kNoGlue},
    {"rename", WorldAct::kRename, WorldReply::kDone, "ID NEW_NAME"},
};

struct WorldRequest {
  const WorldCall* call = nullptr;
  std::vector<double> sizes_m, pose, color;  // colour from 0 to 255
  std::vector<std::string> words;
  std::string frame, name;
  bool gravity = false, collision = true, on = false;
  bool typed = false;  // by a person: a program sends all arguments, and truth values as [ok] and [fail]

  /// Stores `value` as argument `part` of the call. Returns false if it does not fit.
  bool Take(std::string_view part, const BottleValue& value);
};

/// `makeSphere RADIUS X Y Z …`
std::string WorldCallUsage(const WorldCall& call);
/// Reads the arguments after the call's name. Returns false if they do not fit.
bool ReadWorldParts(const Bottle& bottle, std::size_t from, WorldRequest& request);
/// Normalises the names of frame and model. Returns why the request is not possible, as far as that is known
/// without the world; empty if it is.
std::string WhyNoRequest(WorldRequest& request);

}  // namespace coopdyn
