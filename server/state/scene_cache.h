// SPDX-License-Identifier: MIT
// A place on a scene for what others derive from it at first use, e.g. sensing. Any thread.
#pragma once

#include <memory>

#include "server/base/mutex.h"

namespace coopdyn {

/// Values derived from a scene. Freed with the scene.
struct SceneCache {
  virtual ~SceneCache() = default;
};

class SceneCacheSlot {
 public:
  SceneCacheSlot() = default;
  ~SceneCacheSlot() = default;
  /// A copy of a scene derives its own.
  SceneCacheSlot(const SceneCacheSlot& /*other*/) {}
  SceneCacheSlot& operator=(const SceneCacheSlot&) = delete;

  /// What the first caller's make(), a unique_ptr to a SceneCache, returned. Lives as long as the scene.
  template <typename Make>
  const SceneCache& Get(Make make) const EXCLUDES(mutex_) {
    const MutexLock lock(mutex_);
    if (cache_ == nullptr) cache_ = make();
    return *cache_;
  }

 private:
  mutable Mutex mutex_;
  mutable std::unique_ptr<const SceneCache> cache_ GUARDED_BY(mutex_);
};

}  // namespace coopdyn
