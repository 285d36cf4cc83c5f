// SPDX-License-Identifier: MIT
#include "server/naming/name_client.h"

#include <algorithm>
#include <chrono>
#include <deque>
#include <set>
#include <utility>

#include <boost/asio/buffer.hpp>
#include <boost/asio/connect.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/read_until.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/write.hpp>

#include "server/base/mutex.h"
#include "server/net/io_thread.h"

namespace coopdyn {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr int kYarpPort = 10000;
constexpr milliseconds kAnswerWithin{3000};
constexpr milliseconds kRetryAfter{500};
constexpr milliseconds kGoodbyeWithin{500};
constexpr std::size_t kMaxAnswerBytes = std::size_t{64} << 10;

}  // namespace

struct NameClient::Impl : std::enable_shared_from_this<NameClient::Impl> {
  using ErrorCode = boost::system::error_code;

  /// One request: connect, one line, the answer.
  struct Task {
    std::string name;
    std::string line;  // without the prefix
    bool registers = false;
  };

  Impl(std::string h, int p, Logger l)
      : host(std::move(h)),
        port(p),
        logger(std::move(l)),
        thread("yarp-names", logger),
        resolver(thread.context()),
        socket(thread.context()),
        timer(thread.context()) {}

  void Add(Task task) {
    {
      MutexLock lock(mutex);
      // What has been said of this name and not been told yet is out of date, unless it is being told.
      const auto first = tasks.begin() + (busy ? 1 : 0);
      tasks.erase(std::remove_if(first, tasks.end(), [&](const Task& t) { return t.name == task.name; }),
                  tasks.end());
      if (task.registers) {
        registered.insert(task.name);
      } else if (registered.erase(task.name) == 0) {
        return;
      }
      tasks.push_back(std::move(task));
      if (std::exchange(busy, true)) return;
    }
    thread.Post([self = weak_from_this()] {
      if (const auto impl = self.lock()) impl->Begin();
    });
  }

  /// Connects for the first task.
  void Begin() {
    const std::uint64_t id = ++attempt;
    answer.clear();
    timer.expires_after(kAnswerWithin);
    timer.async_wait([this, id](const ErrorCode& aborted) {
      if (!aborted && id == attempt) Fail("no answer");
    });
    socket = tcp::socket(thread.context());
    resolver.async_resolve(
        host, std::to_string(port), [this, id](const ErrorCode& error, tcp::resolver::results_type found) {
          if (id != attempt) return;
          if (error) return Fail(error.message());
          asio::async_connect(socket, found, [this, id](const ErrorCode& refused, const tcp::endpoint&) {
            if (id != attempt) return;
            if (refused) return Fail(refused.message());
            Ask(id);
          });
        });
  }

  void Ask(std::uint64_t id) {
    {
      MutexLock lock(mutex);
      request = "NAME_SERVER " + tasks.front().line + "\n";
    }
    asio::async_write(socket, asio::buffer(request), [this, id](const ErrorCode& error, std::size_t) {
      if (id != attempt) return;
      if (error) return Fail(error.message());
      ReadLine(id);
    });
  }

  /// The answer ends with a line that starts with '*' or '['.
  void ReadLine(std::uint64_t id) {
    asio::async_read_until(socket, asio::dynamic_buffer(answer, kMaxAnswerBytes), '\n',
                           [this, id](const ErrorCode& error, std::size_t count) {
                             if (id != attempt) return;
                             if (error) return Fail(error.message());
                             const std::string line = answer.substr(0, count);
                             answer.erase(0, count);
                             accepted = accepted || line.starts_with("registration ");
                             if (line[0] == '*' || line[0] == '[') return Done(line);
                             ReadLine(id);
                           });
  }

  void Done(const std::string& last_line) {
    Disconnect();
    const bool was_accepted = std::exchange(accepted, false);
    bool more = false;
    {
      MutexLock lock(mutex);
      const Task task = std::move(tasks.front());
      tasks.pop_front();
      more = busy = !tasks.empty();
      if (!more) idle.NotifyAll();
      failure_told.clear();
      if (task.registers && !was_accepted)
        refused_line = task.name + ": " + last_line.substr(0, last_line.find('\r'));
    }
    if (!refused_line.empty()) logger->error("the YARP name server did not register {}", refused_line);
    refused_line.clear();
    if (more) Begin();
  }

  void Fail(const std::string& why) {
    Disconnect();
    accepted = false;
    if (std::exchange(failure_told, why) != why) {
      logger->warn("YARP name server {} port {}: {}; coopdyn keeps trying", host, port, why);
    }
    timer.expires_after(kRetryAfter);
    timer.async_wait([this, id = attempt](const ErrorCode& aborted) {
      if (!aborted && id == attempt) Begin();
    });
  }

  void Disconnect() {
    ++attempt;  // late handlers of this attempt do nothing
    timer.cancel();
    ErrorCode ignored;
    socket.close(ignored);
  }

  void Goodbye() {
    std::set<std::string> names;
    {
      MutexLock lock(mutex);
      names = registered;
    }
    for (const std::string& name : names) Add({name, "unregister " + name, false});
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

  Mutex mutex;
  ConditionVariable idle;
  std::deque<Task> tasks GUARDED_BY(mutex);  // while busy the first is being told
  std::set<std::string> registered GUARDED_BY(mutex);
  bool busy GUARDED_BY(mutex) = false;

  IoThread thread;
  // What follows belongs to the thread.
  tcp::resolver resolver;
  tcp::socket socket;
  asio::steady_timer timer;
  std::uint64_t attempt = 0;
  std::string request;
  std::string answer;
  std::string failure_told;
  std::string refused_line;
  bool accepted = false;
};

NameClient::NameClient(std::string host, int port, Logger logger)
    : impl_(std::make_shared<Impl>(std::move(host), port, std::move(logger))) {}

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
  impl_->Add(
      {name, "register " + name + " tcp " + (ip.empty() ? "..." : ip) + " " + std::to_string(port), true});
}

void NameClient::Unregister(const std::string& name) {
  impl_->Add({name, "unregister " + name, false});
}

std::size_t NameClient::pending() const {
  MutexLock lock(impl_->mutex);
  return impl_->tasks.size();
}

}  // namespace coopdyn
