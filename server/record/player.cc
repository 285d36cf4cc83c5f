// SPDX-License-Identifier: MIT
#include "server/record/player.h"

#include <utility>

#include "server/record/player_core.h"

namespace coopdyn {

struct Player::Impl {
  Boards boards;
  const Clock& clock;
  PlayerCore core;
};

Player::Player(Boards boards, std::unique_ptr<RunReader> reader, const Clock& clock, Logger logger,
               PlayOptions options, std::uint64_t epoch)
    : impl_(new Impl{boards, clock,
                     PlayerCore(boards, std::move(reader), std::move(logger), options, epoch)}) {}

Player::~Player() = default;

std::string Player::Start() {
  return impl_->core.Start(impl_->clock.Now());
}

std::optional<Edit> Player::Run(std::stop_token stop) {
  PlayerCore& core = impl_->core;
  core.Resume(impl_->clock.Now());
  while (!stop.stop_requested()) {
    const std::uint64_t seen = impl_->boards.bell.count();
    PlayerCore::Work work = core.WorkOnce(impl_->clock.Now());
    if (work.ended_by) return std::move(work.ended_by);
    if (work.wake > impl_->clock.Now()) impl_->boards.bell.WaitUntil(seen, work.wake);
  }
  core.Stop();
  return std::nullopt;
}

std::uint64_t Player::epoch() const {
  return impl_->core.epoch();
}

}  // namespace coopdyn
