// SPDX-License-Identifier: MIT
#include "server/controllers/backend.h"

#include "server/controllers/runner.h"

namespace coopdyn {

struct InProcessBackend::Impl {
  Areas& areas;
  WorkerPool& pool;
  Runner runner;
  Impl(Areas& its_areas, WorkerPool& its_pool) : areas(its_areas), pool(its_pool) {}
};

InProcessBackend::InProcessBackend(Areas& areas, WorkerPool& pool)
    : impl_(std::make_unique<Impl>(areas, pool)) {}

InProcessBackend::~InProcessBackend() {
  InHeader& header = impl_->areas.header();
  header.operation = Operation::kEnd;
  header.item_count = 0;
  impl_->runner.Run(impl_->areas.in.data(), impl_->areas.out.data(), impl_->pool);
}

std::vector<Casualty> InProcessBackend::Run() {
  impl_->runner.Run(impl_->areas.in.data(), impl_->areas.out.data(), impl_->pool);
  return {};
}

void InProcessBackend::Drop(std::uint32_t /*robot*/) {}

}  // namespace coopdyn
