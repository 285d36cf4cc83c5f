// SPDX-License-Identifier: MIT
// The parts of a body as elements of SDF. One thread.
#pragma once

#include <tinyxml2.h>

#include <string>
#include <vector>

#include "server/mjcf/meshes.h"
#include "server/mjcf/source.h"

namespace coopdyn::mjcf {

/// The <collision> and <visual> of a geom in a link; `X_LB`: of the geom's body in the link.
void AddGeom(int geom, const Pose& X_LB, const Source& source, Meshes& meshes, tinyxml2::XMLElement& link);

/// The <link> of a body that stands at `X_MB` in its model.
void AddLink(int body, const Pose& X_MB, const Source& source, Meshes& meshes, tinyxml2::XMLElement& model);

/// One joint follows another: their positions are those from the pose in which the model is written.
struct Follower {
  int leader = 0;
  double multiplier = 1, offset = 0;
};
/// What an equality of joints makes of each; by joint.
struct Couplings {
  std::map<int, Follower> followers;
  std::map<int, double> locked;  // at this position
};

/// The <joint>s that lead to a body, with links without shapes between them; `X_MB`: of the body in its
/// model. Nothing for a free body.
void AddJoints(int body, const Pose& X_MB, const Couplings& couplings, bool has_loops, const Source& source,
               tinyxml2::XMLElement& model);
/// What the first of them is called.
std::string FirstJointName(int body, const Source& source);

/// The <sensor>s of the bodies `bodies`, in their links and joints, and thrusters of sites.
void AddSensors(const std::vector<int>& bodies, const Source& source, tinyxml2::XMLElement& model);
void AddThrusters(const std::vector<int>& bodies, const Source& source, tinyxml2::XMLElement& model);
/// Says which sensors have no equal here.
void SaySensors(const Source& source);

}  // namespace coopdyn::mjcf
