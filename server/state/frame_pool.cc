// SPDX-License-Identifier: MIT
#include "server/state/frame_pool.h"

#include <cstddef>
#include <utility>
#include <vector>

#include "server/base/mutex.h"

namespace coopdyn {

class FramePool::Store {
 public:
  struct Buffers {
    std::vector<BodyState> bodies;
    std::vector<ChannelState> channels;
    std::vector<std::uint8_t> commanded;
    std::vector<SentMessage> messages;
    std::vector<double> measured;
    std::vector<Contact> contacts;
  };

  Buffers Take() EXCLUDES(mutex_) {
    const MutexLock lock(mutex_);
    if (free_.empty()) return {};
    Buffers buffers = std::move(free_.back());
    free_.pop_back();
    return buffers;
  }

  void Give(Buffers buffers) EXCLUDES(mutex_) {
    buffers.bodies.clear();
    buffers.channels.clear();
    buffers.commanded.clear();
    buffers.messages.clear();
    buffers.measured.clear();
    buffers.contacts.clear();
    const MutexLock lock(mutex_);
    if (free_.size() < kMost) free_.push_back(std::move(buffers));
  }

 private:
  // The newest frame, the next one, one or two held by readers, and those waiting to be recorded.
  static constexpr std::size_t kMost = 16;

  Mutex mutex_;
  std::vector<Buffers> free_ GUARDED_BY(mutex_);
};

FramePool::FramePool() : store_(std::make_shared<Store>()) {}

std::shared_ptr<Frame> FramePool::Take() {
  std::shared_ptr<Frame> frame(new Frame, [store = store_](Frame* old) {
    const std::unique_ptr<Frame> owned(old);
    owned->cache.reset();  // may refer to the buffers
    store->Give({std::move(owned->bodies), std::move(owned->channels), std::move(owned->commanded),
                 std::move(owned->messages), std::move(owned->measured), std::move(owned->contacts)});
  });
  Store::Buffers buffers = store_->Take();
  frame->bodies = std::move(buffers.bodies);
  frame->channels = std::move(buffers.channels);
  frame->commanded = std::move(buffers.commanded);
  frame->messages = std::move(buffers.messages);
  frame->measured = std::move(buffers.measured);
  frame->contacts = std::move(buffers.contacts);
  return frame;
}

}  // namespace coopdyn
