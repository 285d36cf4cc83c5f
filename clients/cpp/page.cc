// SPDX-License-Identifier: MIT
#include "clients/cpp/page.h"

#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <utility>

#include "clients/cpp/codes.h"

namespace coopdyn::client {
namespace {

constexpr std::size_t kMaxHead = 65536;

/// A socket that is closed at the end.
class Socket {
 public:
  explicit Socket(int fd) : fd_(fd) {}
  ~Socket() { close(fd_); }
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;
  int fd() const { return fd_; }

 private:
  int fd_;
};

/// A file that replaces `name` when it is kept, and is gone else.
class NewFile {
 public:
  explicit NewFile(std::string name)
      : name_(std::move(name)),
        part_(name_ + "." + std::to_string(getpid()) + ".part"),
        out_(part_, std::ios::binary | std::ios::trunc) {
    if (!out_) throw Error(kNotPossible, "cannot write " + name_);
  }
  ~NewFile() {
    std::error_code ignored;
    std::filesystem::remove(part_, ignored);
  }
  NewFile(const NewFile&) = delete;
  NewFile& operator=(const NewFile&) = delete;

  void Write(const char* bytes, std::size_t count) {
    if (!out_.write(bytes, static_cast<std::streamsize>(count)))
      throw Error(kNotPossible, "cannot write " + name_);
  }
  void Keep() {
    out_.close();
    std::error_code failed;
    if (out_) std::filesystem::rename(part_, name_, failed);
    if (!out_ || failed) throw Error(kNotPossible, "cannot write " + name_);
  }

 private:
  const std::string name_, part_;
  std::ofstream out_;
};

/// The next bytes; none at the end. Each wait is at most `timeout_s`.
std::size_t ReadSome(int fd, char* to, std::size_t size, double timeout_s, const std::string& what) {
  const Deadline deadline = After(timeout_s);
  while (true) {
    const ssize_t n = read(fd, to, size);
    if (n >= 0) return static_cast<std::size_t>(n);
    if (errno != EAGAIN && errno != EINTR) return 0;
    if (Until(deadline) <= 0) throw Error(kTimedOut, "no " + what + ": the page does not answer");
    WaitReadable({fd}, Until(deadline));
  }
}

struct Head {
  int status = 0;
  std::size_t length = 0;  // of the body
  std::string rest;        // of the body, that has come with it
};

Head ReadHead(int fd, double timeout_s, const std::string& what) {
  std::string bytes;
  std::size_t end = std::string::npos;
  char buffer[4096];
  while ((end = bytes.find("\r\n\r\n")) == std::string::npos && bytes.size() < kMaxHead) {
    const std::size_t n = ReadSome(fd, buffer, sizeof(buffer), timeout_s, what);
    if (n == 0) break;
    bytes.append(buffer, n);
  }
  Head head;
  const bool http = end != std::string::npos && bytes.starts_with("HTTP/1.") && bytes.size() > 12;
  if (http) std::from_chars(bytes.data() + 9, bytes.data() + 12, head.status);
  std::string fields = bytes.substr(0, http ? end + 2 : 0);
  std::transform(fields.begin(), fields.end(), fields.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  const std::size_t field = fields.find("\r\ncontent-length:");
  if (head.status == 0 || field == std::string::npos)
    throw Error(Error::kNoConnection, "no " + what + ": the page does not answer as a daemon's does");
  const std::size_t digits = fields.find_first_not_of(" \t", field + 17);
  std::from_chars(fields.data() + digits, fields.data() + fields.size(), head.length);
  head.rest = bytes.substr(end + 4);
  return head;
}

}  // namespace

std::string UrlHere(const Address& daemon, const std::string& url) {
  const std::size_t begin = url.find("://");
  if (begin == std::string::npos) return "";
  const std::size_t path = std::min(url.find('/', begin + 3), url.size());
  const std::size_t colon = url.rfind(':', path);
  const std::string& host = daemon.host();
  return "http://" + (host.find(':') != std::string::npos ? "[" + host + "]" : host) +
         (colon > begin ? url.substr(colon) : url.substr(path));
}

void Download(const Address& daemon, const std::string& url, const std::string& path, const std::string& file,
              const char* what, double timeout_s) {
  std::string here = UrlHere(daemon, url);
  if (here.empty())
    throw Error(kNotPossible, "the daemon was started with --no-http, so there are no pictures and no files");
  here = here.substr(here.find("://") + 3);
  const Address page(here.substr(0, here.find('/', here.rfind(':'))), "", "", daemon.timeout_s());
  const Socket socket(page.Dial(After(daemon.timeout_s())));
  WriteAll(socket.fd(),
           "GET " + path + " HTTP/1.1\r\nHost: " + page.text() + "\r\nConnection: close\r\n\r\n");
  Head head = ReadHead(socket.fd(), timeout_s, what);
  if (head.status != 200) {
    std::string said = std::move(head.rest);
    char buffer[4096];
    while (said.size() < std::min(head.length, kMaxHead)) {
      const std::size_t n = ReadSome(socket.fd(), buffer, sizeof(buffer), timeout_s, what);
      if (n == 0) break;
      said.append(buffer, n);
    }
    while (said.ends_with('\n')) said.pop_back();
    throw Error(head.status == 404 ? kNoSuchName : kNotPossible, "no " + std::string(what) + ": " + said);
  }
  NewFile out(file);
  std::size_t got = std::min(head.rest.size(), head.length);
  out.Write(head.rest.data(), got);
  std::string buffer(std::size_t{1} << 18, '\0');
  while (got < head.length) {
    const std::size_t n =
        ReadSome(socket.fd(), buffer.data(), std::min(buffer.size(), head.length - got), timeout_s, what);
    if (n == 0)
      throw Error(Error::kNoConnection, "the connection broke before the " + std::string(what) +
                                            " was whole: " + std::to_string(got) + " of " +
                                            std::to_string(head.length) + " bytes have come");
    out.Write(buffer.data(), n);
    got += n;
  }
  out.Keep();
}

}  // namespace coopdyn::client
