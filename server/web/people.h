// SPDX-License-Identifier: MIT
// The people viewing the page: their names and selections. UI thread.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace coopdyn {

/// {"type":"me","name":"Ana","selected":"BOX_1"}.
struct PageMe {
  static constexpr std::size_t kMaxNameBytes = 40, kMaxSelectedBytes = 63;
  std::string name;      // empty if not given
  std::string selected;  // name of a thing or robot; empty if none
};

/// A page that is notified of the people.
class PeopleWatcher {
 public:
  virtual ~PeopleWatcher() = default;
  /// `people`: {"type":"people","people":[{"id":1,"name":"Ana","selected":"BOX_1"}]}, by increasing id.
  virtual void OnPeople(const std::shared_ptr<const std::string>& people) = 0;
};

class People {
 public:
  /// Adds a person and returns its id. The first Set() notifies the watchers.
  std::uint64_t Enter(std::weak_ptr<PeopleWatcher> watcher);
  /// Updates a person and notifies all watchers.
  void Set(std::uint64_t id, PageMe me);
  void Leave(std::uint64_t id);

 private:
  struct Person {
    std::uint64_t id = 0;
    PageMe me;
    std::weak_ptr<PeopleWatcher> watcher;
  };
  void TellAll();

  std::vector<Person> people_;
  std::uint64_t newest_ = 0;
};

}  // namespace coopdyn
