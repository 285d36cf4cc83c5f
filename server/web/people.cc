// SPDX-License-Identifier: MIT
#include "server/web/people.h"

#include <algorithm>
#include <boost/json.hpp>
#include <utility>

#include "protocol/json_text.h"

namespace coopdyn {

std::uint64_t People::Enter(std::weak_ptr<PeopleWatcher> watcher) {
  people_.push_back({++newest_, {}, std::move(watcher)});
  return newest_;
}

void People::Set(std::uint64_t id, PageMe me) {
  const auto person =
      std::find_if(people_.begin(), people_.end(), [id](const Person& one) { return one.id == id; });
  if (person == people_.end()) return;
  person->me = std::move(me);
  TellAll();
}

void People::Leave(std::uint64_t id) {
  if (std::erase_if(people_, [id](const Person& one) { return one.id == id; }) > 0) TellAll();
}

void People::TellAll() {
  std::erase_if(people_, [](const Person& one) { return one.watcher.expired(); });
  boost::json::array list;
  for (const Person& one : people_) {
    list.push_back({{"id", one.id}, {"name", one.me.name}, {"selected", one.me.selected}});
  }
  const auto text = std::make_shared<const std::string>(
      JsonText(boost::json::object{{"type", "people"}, {"people", std::move(list)}}));
  for (const Person& one : people_) {
    if (const auto watcher = one.watcher.lock()) watcher->OnPeople(text);
  }
}

}  // namespace coopdyn
