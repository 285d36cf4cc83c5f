// SPDX-License-Identifier: MIT
// The world interface of gazebo-yarp-plugins 4 (thrift/worldinterface/worldinterface_rpc.thrift): its calls
// (makeBox, setPose, getList, …) as commands of our module /world. Positions are in m and of a thing's
// centre, angles in rad (roll, pitch, yaw about the fixed axes), both in the world or in the frame that the
// call names.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <string_view>

#include "server/base/mutex.h"
#include "server/yarp/translator.h"

namespace coopdyn {

/// The things made through the interface: listed by getList, deleted by deleteAll. Thread-safe.
class YarpMadeThings {
 public:
  /// `id` and `name` in /world.
  void Add(std::int32_t id, std::string name) EXCLUDES(mutex_);
  void Remove(std::int32_t id) EXCLUDES(mutex_);
  /// True only if the name also fits, because another scenario may have reused the id.
  bool Has(std::int32_t id, std::string_view name) const EXCLUDES(mutex_);

 private:
  mutable Mutex mutex_;
  std::map<std::int32_t, std::string> names_ GUARDED_BY(mutex_);
};

/// For one connection. `made`: shared by the connections.
std::unique_ptr<YarpTranslator> MakeWorldTranslator(
    std::shared_ptr<YarpMadeThings> made = std::make_shared<YarpMadeThings>());

}  // namespace coopdyn
