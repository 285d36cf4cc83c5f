// SPDX-License-Identifier: MIT
// Reads MJCF with libmujoco, including files for newer versions of it. One thread.
#pragma once

#include <mujoco/mujoco.h>

#include <map>
#include <memory>
#include <string>

#include "server/mjcf/words.h"

namespace coopdyn::mjcf {

/// A mesh that libmujoco cannot read.
struct UnreadMesh {
  std::string
      name;  // its file as written, relative to the model's folder; empty: coopdyn cannot read it either
  std::string file;   // path of its file; empty: not found
  std::string scale;  // x y z, usually empty
};

struct Loaded {
  struct Delete {
    void operator()(mjModel* model) const { mj_deleteModel(model); }
  };
  std::unique_ptr<mjModel, Delete> model;  // null if the file cannot be read
  /// Meshes that libmujoco cannot read, by name. In `model` a small box replaces each, which keeps the frame
  /// of the mesh's file.
  std::map<std::string, UnreadMesh> unread_meshes;
  bool has_joint_limits = false;  // user data of joints hold their force limits (actuatorfrcrange)
  std::string why;                // libmujoco's error, with its line
};

/// Loads the MJCF `file`. Leaves out what this libmujoco does not know and reports it. If the rest cannot be
/// loaded either, `why` is the error of the unchanged file.
Loaded Load(const std::string& file, Words& words);

}  // namespace coopdyn::mjcf
