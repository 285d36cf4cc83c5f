// SPDX-License-Identifier: MIT
#include "server/naming/name_client.h"

#include <algorithm>
#include <chrono>
#include <deque>
#include <exception>
#include <map>
#include <utility>
#include <vector>

#include <boost/asio/awaitable.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/use_awaitable.hpp>

#include "server/base/mutex.h"
#include "server/net/dialled.h"
#include "server/net/io_thread.h"

namespace coopdyn {
namespace {

namespace asio = boost::asio;
using asio::use_awaitable;
using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr int kYarpPort = 10000;
constexpr milliseconds kAnswerWithin{3000};
constexpr milliseconds kRetryAfter{500};
constexpr milliseconds kGoodbyeWithin{500};

}  // namespace

struct NameClient::Impl {
  /// One request: connect, one line, the answer.
  struct Task {
    std::string name;
    std::string line;  // without the prefix
    enum class Kind { kRegister, kUnregister, kCheck } kind = Kind::kUnregister;
  };

  Impl(std::string h, int p, Logger l, milliseconds c)
      : host(std::move(h)), port(p), logger(std::move(l)), check_every(c), thread("yarp-names", logger) {}

  void Add(Task task) {
    {
      MutexLock lock(mutex);
      // Drops requests about this name that are queued but not being sent: they are out of date.
      const auto first = tasks.begin() + (busy ? 1 : 0);
      tasks.erase(std::remove_if(first, tasks.end(), [&](const Task& t) { return t.name == task.name; }),
                  tasks.end());
      if (task.kind == Task::Kind::kRegister) {
        registered[task.name] = task.line;
        if (!std::exchange(checking, true)) Spawn(Check());
      } else if (registered.erase(task.name) == 0) {
        return;
      }
      tasks.push_back(std::move(task));
      if (std::exchange(busy, true)) return;
    }
    Spawn(TellAll());
  }

  void Spawn(asio::awaitable<void> work) {
    asio::co_spawn(thread.context(), std::move(work), [](const std::exception_ptr& thrown) {
      if (thrown) std::rethrow_exception(thrown);  // the thread logs it
    });
  }

  /// Checks periodically whether the server still knows one of our names: after a restart it does not.
  asio::awaitable<void> Check() {
    asio::steady_timer pause(thread.context());
    while (true) {
      pause.expires_after(check_every);
      co_await pause.async_wait(use_awaitable);
      {
        const MutexLock lock(mutex);
        if (busy || registered.empty()) continue;
        tasks.push_back({"", "query " + registered.begin()->first, Task::Kind::kCheck});
        busy = true;
      }
      Spawn(TellAll());
    }
  }

  void RegisterAllAgain() {
    std::map<std::string, std::string> names;
    {
      const MutexLock lock(mutex);
      names = registered;
    }
    logger->info("YARP name server {} port {} has forgotten our names: they are registered again", host,
                 port);
    for (const auto& [name, line] : names) Add({name, line, Task::Kind::kRegister});
  }

  /// Sends the queued requests one after the other until none is left.
  asio::awaitable<void> TellAll() {
    std::string failure_told;
    while (true) {
      const Task task = First();
      std::string answer;
      const std::string failure = co_await Ask(task, answer);
      if (!failure.empty()) {
        if (std::exchange(failure_told, failure) != failure) {
          logger->warn("YARP name server {} port {}: {}; coopdyn keeps trying", host, port, failure);
        }
        asio::steady_timer pause(thread.context(), kRetryAfter);
        co_await pause.async_wait(use_awaitable);
        continue;
      }
      failure_told.clear();
      if (task.kind == Task::Kind::kCheck && !answer.empty()) RegisterAllAgain();
      if (task.kind == Task::Kind::kRegister && !answer.empty()) {
        logger->error("the YARP name server did not register {}: {}", task.name, answer);
      }
      const MutexLock lock(mutex);
      tasks.pop_front();
      busy = !tasks.empty();
      if (busy) continue;
      idle.NotifyAll();
      co_return;
    }
  }

  Task First() {
    const MutexLock lock(mutex);
    return tasks.front();
  }

  /// Sends the request of `task`; the answer ends with a line that starts with '*' or '['. Returns an error
  /// text, or empty if the server answered. Then `refusal` is that last line, or empty if the server returned
  /// a registration.
  asio::awaitable<std::string> Ask(const Task& task, std::string& refusal) {
    const auto server = Dialled::Begin(thread.context(), kAnswerWithin);
    try {
      co_await server->Connect(host, port);
      co_await server->Write("NAME_SERVER " + task.line + "\n");
      bool accepted = false;
      while (true) {
        const std::string next = co_await server->ReadLine();
        accepted = accepted || next.starts_with("registration ");
        if (next[0] != '*' && next[0] != '[') continue;
        if (!accepted) refusal = next.substr(0, next.find('\r'));
        co_return "";
      }
    } catch (const boost::system::system_error& error) {
      co_return error.code() == asio::error::operation_aborted ? "no answer" : error.code().message();
    }
  }

  void Goodbye() {
    std::vector<std::string> names;
    {
      MutexLock lock(mutex);
      for (const auto& [name, line] : registered) names.push_back(name);
    }
    for (const std::string& name : names) Add({name, "unregister " + name});
    const auto deadline = steady_clock::now() + kGoodbyeWithin;
    {
      MutexLock lock(mutex);
      while (busy) {
        if (!idle.WaitUntil(mutex, deadline)) break;
      }
    }
    thread.Stop();
  }

  const std::string host;
  const int port;
  const Logger logger;
  const milliseconds check_every;

  Mutex mutex;
  ConditionVariable idle;
  std::deque<Task> tasks GUARDED_BY(mutex);                         // while busy, the first is being sent
  std::map<std::string, std::string> registered GUARDED_BY(mutex);  // names and their registration lines
  bool checking GUARDED_BY(mutex) = false;
  bool busy GUARDED_BY(mutex) = false;

  IoThread thread;
};

NameClient::NameClient(std::string host, int port, Logger logger, milliseconds check_every)
    : impl_(std::make_unique<Impl>(std::move(host), port, std::move(logger), check_every)) {}

NameClient::~NameClient() {
  impl_->Goodbye();
}

std::string NameClient::ParseServer(const std::string& text, std::string& host, int& port) {
  const std::string example = "write HOST:PORT, as in labserver:10000";
  const bool bracketed = text.starts_with('[');
  const std::size_t bracket = bracketed ? text.find(']') : 0;
  if (bracket == std::string::npos) return example;
  const std::size_t colon = text.find(':', bracket);
  if (bracketed && bracket + 1 < text.size() && colon != bracket + 1) return example;
  if (!bracketed && colon != text.rfind(':')) return example + " (an IPv6 address in brackets)";
  host = bracketed ? text.substr(1, bracket - 1) : text.substr(0, colon);
  port = kYarpPort;
  if (host.empty()) return example;
  if (colon == std::string::npos) return {};
  const std::string digits = text.substr(colon + 1);
  const bool number = !digits.empty() && digits.size() <= 5 &&
                      std::all_of(digits.begin(), digits.end(), [](char c) { return c >= '0' && c <= '9'; });
  port = number ? std::stoi(digits) : 0;
  return port >= 1 && port <= 65535 ? "" : example;
}

void NameClient::Register(const std::string& name, const std::string& ip, int port) {
  impl_->Add({name, "register " + name + " tcp " + (ip.empty() ? "..." : ip) + " " + std::to_string(port),
              Impl::Task::Kind::kRegister});
}

void NameClient::Unregister(const std::string& name) {
  impl_->Add({name, "unregister " + name});
}

std::size_t NameClient::pending() const {
  MutexLock lock(impl_->mutex);
  return impl_->tasks.size();
}

}  // namespace coopdyn
