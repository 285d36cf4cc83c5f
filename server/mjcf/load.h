// SPDX-License-Identifier: MIT
// Reads MJCF by libmujoco, also what was written for newer versions of it. One thread.
#pragma once

#include <mujoco/mujoco.h>

#include <map>
#include <memory>
#include <string>

#include "server/mjcf/words.h"

namespace coopdyn::mjcf {

struct UnreadMesh {
  std::string
      name;  // of its file, as it is written, from the model's folder; empty: coopdyn does not read it either
  std::string file;   // empty: it is nowhere
  std::string scale;  // x y z, mostly empty
};

struct Loaded {
  struct Delete {
    void operator()(mjModel* model) const { mj_deleteModel(model); }
  };
  std::unique_ptr<mjModel, Delete> model;  // null: it cannot be read
  /// Meshes that libmujoco does not read, by name. In `model` a small box stands for each, so that its frame
  /// is that of the file.
  std::map<std::string, UnreadMesh> unread_meshes;
  bool has_joint_limits = false;  // the greatest force on a joint is in its user data
  std::string why;                // in libmujoco's words, with its line
};

/// The MJCF `file`. What this libmujoco does not know is left out and said; if that does not help, `why`
/// tells what was wrong with the file as it is.
Loaded Load(const std::string& file, Words& words);

}  // namespace coopdyn::mjcf
