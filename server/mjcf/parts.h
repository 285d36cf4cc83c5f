// SPDX-License-Identifier: MIT
// Writes the parts of a body as SDF elements. One thread.
#pragma once

#include <tinyxml2.h>

#include <string>
#include <vector>

#include "server/mjcf/meshes.h"
#include "server/mjcf/source.h"

namespace coopdyn::mjcf {

/// Adds the <collision> and <visual> of a geom to a link. `X_LB`: pose of the geom's body in the link.
void AddGeom(int geom, const Pose& X_LB, const Source& source, Meshes& meshes, tinyxml2::XMLElement& link);

/// Adds the <link> of a body with pose `X_MB` in its model.
void AddLink(int body, const Pose& X_MB, const Source& source, Meshes& meshes, tinyxml2::XMLElement& model);

/// A joint that follows another one. Positions count from the pose in which the model is written.
struct Follower {
  int leader = 0;
  double multiplier = 1, offset = 0;
};
/// The effect of joint equalities, by joint.
struct Couplings {
  std::map<int, Follower> followers;
  std::map<int, double> locked;  // position at which the joint is locked
};

/// Adds the <joint>s between a body and its parent, with links without shapes between them. `X_MB`: pose of
/// the body in its model. Adds nothing for a free body.
void AddJoints(int body, const Pose& X_MB, const Couplings& couplings, bool has_loops, const Source& source,
               tinyxml2::XMLElement& model);
/// The name of the first of these joints.
std::string FirstJointName(int body, const Source& source);

/// Adds the <sensor>s of `bodies` to their links and joints.
void AddSensors(const std::vector<int>& bodies, const Source& source, tinyxml2::XMLElement& model);
/// Adds a thruster for each actuator on a site of `bodies`.
void AddThrusters(const std::vector<int>& bodies, const Source& source, tinyxml2::XMLElement& model);
/// Reports sensors that have no equivalent in coopdyn.
void SaySensors(const Source& source);

}  // namespace coopdyn::mjcf
