// SPDX-License-Identifier: MIT
// Who looks at the page, as each calls himself, and what each has selected. UI thread.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace coopdyn {

/// {"type":"me","name":"Ana","selected":"BOX_1"}.
struct PageMe {
  static constexpr std::size_t kMaxNameBytes = 40, kMaxSelectedBytes = 63;
  std::string name;      // empty: none was given
  std::string selected;  // of a thing or robot; empty: nothing
};

/// A page that hears who else looks.
class PeopleWatcher {
 public:
  virtual ~PeopleWatcher() = default;
  /// `people`: {"type":"people","people":[{"id":1,"name":"Ana","selected":"BOX_1"}]}, by increasing id.
  virtual void OnPeople(const std::shared_ptr<const std::string>& people) = 0;
};

class People {
 public:
  /// A new one comes; returns its number. The others are told with the first Set().
  std::uint64_t Enter(std::weak_ptr<PeopleWatcher> watcher);
  /// Says something else of itself.
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
