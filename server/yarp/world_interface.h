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

/// What was made through the interface: what getList tells and deleteAll deletes. Any thread.
class YarpMadeThings {
 public:
  /// Id and name in /world.
  void Add(std::int32_t id, std::string name) EXCLUDES(mutex_);
  void Remove(std::int32_t id) EXCLUDES(mutex_);
  /// Another scenario may have given the id to another thing, so the name must fit, too.
  bool Has(std::int32_t id, std::string_view name) const EXCLUDES(mutex_);

 private:
  mutable Mutex mutex_;
  std::map<std::int32_t, std::string> names_ GUARDED_BY(mutex_);
};

/// Of one connection. `made`: by all connections that share it.
std::unique_ptr<YarpTranslator> MakeWorldTranslator(
    std::shared_ptr<YarpMadeThings> made = std::make_shared<YarpMadeThings>());

}  // namespace coopdyn
