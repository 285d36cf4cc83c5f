// SPDX-License-Identifier: MIT
#include "server/devices/step_inbox.h"

#include <algorithm>
#include <iterator>
#include <thread>
#include <utility>

#include "server/base/mutex.h"

namespace coopdyn {

namespace {

bool SameStep(const Frame& a, const Frame& b) {
  return a.epoch == b.epoch && a.step == b.step;
}

bool IsLater(const Frame& a, const Frame& b) {
  return a.epoch != b.epoch ? a.epoch > b.epoch && a.step > 0 : a.step > b.step;
}

}  // namespace

/// The part that other threads write to.
class StepInbox::Mailbox {
 public:
  Mailbox(Post post, const Post& hand_over, StepInbox* owner)
      : post_(std::move(post)), hand_over_(hand_over ? hand_over : post_), owner_(owner) {}

  static void PutFrame(const std::shared_ptr<Mailbox>& self, const FramePtr& frame) {
    {
      const MutexLock lock(self->mutex_);
      if (self->closed_) return;
      Item item;
      item.frame = frame;
      if (self->frames_ >= kMaxFrames) item.dropped = self->DropOldest();
      self->items_.push_back(std::move(item));
      ++self->frames_;
      if (self->patient_ || !self->NeedsWake()) return;
    }
    Wake(self, self->post_);
  }

  static void PutResult(const std::shared_ptr<Mailbox>& self, StepListener& listener, ClientId client,
                        const StepResult& result) {
    {
      const MutexLock lock(self->mutex_);
      if (self->closed_) return;
      if (self->busy_on_ == std::this_thread::get_id() && self->owner_->asking_ == client) {
        self->owner_->own_ = result;
        return;
      }
      Item item;
      item.listener = &listener;
      item.client = client;
      item.result = result;
      self->items_.push_back(std::move(item));
      if (!self->NeedsWake()) return;
    }
    // In real time the stepping thread only wakes other threads: its periods are for physics.
    Wake(self, result.mode == Mode::kLockstep ? self->hand_over_ : self->post_);
  }

  static void PutWork(const std::shared_ptr<Mailbox>& self, std::function<void()> work) {
    {
      const MutexLock lock(self->mutex_);
      if (self->closed_) return;
      Item item;
      item.work = std::move(work);
      self->items_.push_back(std::move(item));
      if (!self->NeedsWake()) return;
    }
    Wake(self, self->post_);
  }

  void SetBusy() {
    const MutexLock lock(mutex_);
    busy_on_ = std::this_thread::get_id();
  }

  /// Appends all items to `queue`. Returns false if there are none; then, with `leave`, the owner is no
  /// longer busy. `patient`: frames alone do not count, and need not wake the owner.
  bool TakeInto(std::deque<Item>& queue, bool leave, bool patient) {
    const MutexLock lock(mutex_);
    if (items_.size() == (patient ? frames_ : 0)) {
      if (leave) busy_on_ = {};
      patient_ = patient;
      return false;
    }
    if (queue.empty()) {
      queue.swap(items_);
    } else {
      queue.insert(queue.end(), std::make_move_iterator(items_.begin()),
                   std::make_move_iterator(items_.end()));
      items_.clear();
    }
    frames_ = 0;
    return true;
  }

  void Close() {
    std::deque<Item> items;  // frames are freed outside the lock
    const MutexLock lock(mutex_);
    closed_ = true;
    items.swap(items_);
    owner_ = nullptr;
  }

 private:
  bool NeedsWake() REQUIRES(mutex_) {
    if (busy_on_ != std::thread::id() || posted_) return false;
    posted_ = true;
    return true;
  }

  /// Removes the oldest frame; returns the number of lost frames that no later frame reports.
  int DropOldest() REQUIRES(mutex_) {
    const auto oldest =
        std::find_if(items_.begin(), items_.end(), [](const Item& item) { return item.frame != nullptr; });
    const int lost = oldest->dropped + 1;
    items_.erase(oldest);
    --frames_;
    const auto next =
        std::find_if(items_.begin(), items_.end(), [](const Item& item) { return item.frame != nullptr; });
    if (next == items_.end()) return lost;
    next->dropped += lost;
    return 0;
  }

  static void Wake(const std::shared_ptr<Mailbox>& self, const Post& post) {
    post([self] {
      StepInbox* owner = nullptr;
      {
        const MutexLock lock(self->mutex_);
        self->posted_ = false;
        owner = self->owner_;
      }
      // Runs on the owner's thread, which also destroys the owner, or in that thread's turn: the owner is
      // alive.
      if (owner != nullptr) Scope scope(*owner);
    });
  }

  const Post post_, hand_over_;
  Mutex mutex_;
  std::deque<Item> items_ GUARDED_BY(mutex_);
  std::size_t frames_ GUARDED_BY(mutex_) = 0;   // in items_
  bool posted_ GUARDED_BY(mutex_) = false;      // a wake-up is pending
  std::thread::id busy_on_ GUARDED_BY(mutex_);  // the owner is in a Scope on this thread and looks here when
                                                // it leaves
  bool patient_ GUARDED_BY(mutex_) = false;     // frames need not wake the owner
  bool closed_ GUARDED_BY(mutex_) = false;
  StepInbox* owner_ GUARDED_BY(mutex_);
};

StepInbox::StepInbox(CommandBoard& board, const FrameBoard& frames, Post post, const Post& hand_over)
    : board_(board), frames_(frames), mailbox_(std::make_shared<Mailbox>(std::move(post), hand_over, this)) {}

StepInbox::~StepInbox() {
  Close();
}

void StepInbox::Close() {
  listeners_.clear();
  if (observer_ != 0) board_.RemoveObserver(std::exchange(observer_, 0));
  mailbox_->Close();
}

void StepInbox::Enter(ClientId asking) {
  if (depth_++ > 0) return;
  asking_ = asking;
  own_.reset();
  mailbox_->SetBusy();
}

void StepInbox::Leave() {
  // depth_ stays above 0 meanwhile: a listener that opens a Scope must not start handling again.
  if (depth_ == 1) {
    asking_ = 0;
    do {
      while (next_ < queue_.size()) {
        Item item = std::move(queue_[next_++]);
        Handle(item);
      }
      queue_.clear();
      next_ = 0;
    } while (Fetch(true));
  }
  --depth_;
}

bool StepInbox::Fetch(bool leave) {
  return mailbox_->TakeInto(queue_, leave, patient_);
}

void StepInbox::Handle(Item& item) {
  if (item.frame != nullptr) {
    Deliver(item.frame, item.dropped);
  } else if (item.listener != nullptr) {
    item.listener->OnStepEnd(item.client, item.result);
  } else if (item.work) {
    item.work();
  }
}

void StepInbox::HandleFrames() {
  Fetch(false);
  for (std::size_t i = next_; i < queue_.size(); ++i) {
    const FramePtr frame = std::move(queue_[i].frame);
    if (frame != nullptr) Deliver(frame, queue_[i].dropped);
  }
}

void StepInbox::Deliver(const FramePtr& frame, int dropped) {
  if (observer_ == 0 || (seen_ != nullptr && SameStep(*frame, *seen_))) return;
  seen_ = frame;
  bool taken = false;
  for (StepListener* listener : listeners_) taken |= listener->OnFrame(frame, dropped);
  patient_ = !taken;
}

FramePtr StepInbox::Current() {
  FramePtr latest = frames_.Latest();
  if (observer_ == 0 || latest == nullptr || patient_) return latest;
  HandleFrames();
  // A frame is published before its observers are called. Makes its pushes now; the observer's call is then
  // ignored.
  if (seen_ == nullptr || IsLater(*latest, *seen_)) Deliver(latest, 0);
  return latest;
}

void StepInbox::TakesMore() {
  const Scope scope(*this);
  patient_ = false;
}

std::optional<StepResult> StepInbox::TakeOwn() {
  if (own_ && observer_ != 0) HandleFrames();
  return std::exchange(own_, std::nullopt);
}

StepDone StepInbox::Waiter(StepListener& listener, ClientId client) {
  return [mailbox = mailbox_, &listener, client](const StepResult& result) {
    Mailbox::PutResult(mailbox, listener, client, result);
  };
}

StepInbox::Poster StepInbox::MakePoster() {
  return [mailbox = mailbox_](std::function<void()> work) { Mailbox::PutWork(mailbox, std::move(work)); };
}

void StepInbox::Subscribe(StepListener& listener) {
  patient_ = false;
  if (std::find(listeners_.begin(), listeners_.end(), &listener) != listeners_.end()) return;
  listeners_.push_back(&listener);
  if (observer_ != 0) return;
  // The newest step is not pushed: the reply to `subscribe` reports it already.
  seen_ = frames_.Latest();
  observer_ =
      board_.AddObserver([mailbox = mailbox_](const FramePtr& frame) { Mailbox::PutFrame(mailbox, frame); });
}

void StepInbox::Unsubscribe(StepListener& listener) {
  std::erase(listeners_, &listener);
  if (!listeners_.empty() || observer_ == 0) return;
  board_.RemoveObserver(std::exchange(observer_, 0));
  seen_ = nullptr;
}

}  // namespace coopdyn
