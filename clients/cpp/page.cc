// SPDX-License-Identifier: MIT
#include "clients/cpp/page.h"

#include <unistd.h>

#include <algorithm>
#include <boost/asio/buffer.hpp>
#include <boost/asio/error.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http.hpp>
#include <cerrno>
#include <filesystem>
#include <utility>

namespace coopdyn::client {
namespace {

namespace http = boost::beast::http;
using boost::system::error_code;

/// A connection as a stream for Beast. Each wait takes at most `timeout_s`.
class PageStream {
 public:
  PageStream(Socket socket, double timeout_s) : socket_(std::move(socket)), timeout_s_(timeout_s) {}
  int fd() const { return socket_.fd(); }

  template <class Buffers>
  std::size_t read_some(const Buffers& buffers, error_code& failed) {
    const boost::asio::mutable_buffer to(*boost::asio::buffer_sequence_begin(buffers));
    const Deadline deadline = After(timeout_s_);
    while (true) {
      const ssize_t n = read(fd(), to.data(), to.size());
      failed = {};
      if (n > 0) return static_cast<std::size_t>(n);
      failed = boost::asio::error::eof;
      if (n == 0 || (errno != EAGAIN && errno != EINTR)) return 0;
      failed = boost::asio::error::timed_out;
      if (SecondsUntil(deadline) <= 0) return 0;
      WaitReadable({fd()}, SecondsUntil(deadline));
    }
  }
  template <class Buffers>
  std::size_t read_some(const Buffers& buffers) {
    error_code failed;
    const std::size_t n = read_some(buffers, failed);
    if (failed) throw boost::system::system_error(failed);
    return n;
  }

 private:
  Socket socket_;
  double timeout_s_;
};

/// A temporary file; the destructor removes it unless it was renamed.
struct PartFile {
  explicit PartFile(const std::string& name) : part(name + "." + std::to_string(getpid()) + ".part") {}
  ~PartFile() {
    std::error_code ignored;
    std::filesystem::remove(part, ignored);
  }
  PartFile(const PartFile&) = delete;
  PartFile& operator=(const PartFile&) = delete;

  const std::string part;
};

}  // namespace

std::string UrlHere(const Address& daemon, const std::string& url) {
  if (daemon.port() == 0)
    return url.starts_with("http") ? url : "";  // a unix socket: the page is on this machine
  const std::size_t begin = url.find("://");
  if (begin == std::string::npos) return "";
  const std::size_t path = std::min(url.find('/', begin + 3), url.size());
  const std::size_t colon = url.rfind(':', path);
  const std::string& host = daemon.host();
  return "http://" + (host.find(':') != std::string::npos ? "[" + host + "]" : host) +
         (colon > begin ? url.substr(colon) : url.substr(path));
}

void Download(const Address& daemon, const std::string& url, const std::string& path, const std::string& file,
              const std::string& what, double timeout_s) {
  std::string here = UrlHere(daemon, url);
  if (here.empty())
    throw Error(kNotPossible, "the daemon was started with --no-http, so there are no pictures and no files");
  here = here.substr(here.find("://") + 3);
  const std::size_t slash = std::min(here.find('/'), here.size());
  std::string prefix = here.substr(slash);  // of a seat: /s/ana/
  if (prefix.ends_with('/')) prefix.pop_back();
  const Address page(here.substr(0, slash), "", "", daemon.timeout_s(), "");
  PageStream stream(page.DialPort(After(daemon.timeout_s())), timeout_s);
  const std::string authorization = daemon.Authorization();
  WriteAll(stream.fd(), "GET " + prefix + path + " HTTP/1.1\r\nHost: " + page.text() + "\r\n" +
                            (authorization.empty() ? "" : "Authorization: " + authorization + "\r\n") +
                            "Connection: close\r\n\r\n");

  error_code failed;
  const auto throw_if_silent = [&] {
    if (failed == boost::asio::error::timed_out)
      throw Error(kTimedOut, "no " + what + ": the page does not answer");
  };
  boost::beast::flat_buffer buffer;
  http::response_parser<http::empty_body> head;
  http::read_header(stream, buffer, head, failed);
  throw_if_silent();
  if (failed || !head.content_length())
    throw Error(Error::kNoConnection, "no " + what + ": the page does not answer as a daemon's does");
  const std::uint64_t length = *head.content_length();
  if (head.get().result() != http::status::ok) {
    http::response_parser<http::string_body> reply(std::move(head));
    http::read(stream, buffer, reply, failed);
    throw_if_silent();
    std::string said = reply.get().body();
    said.erase(said.find_last_not_of('\n') + 1);
    throw Error(reply.get().result() == http::status::not_found ? kNoSuchName : kNotPossible,
                "no " + what + ": " + said);
  }
  const PartFile to(file);
  http::response_parser<http::file_body> body(std::move(head));
  body.body_limit(boost::none);
  body.get().body().open(to.part.c_str(), boost::beast::file_mode::write, failed);
  if (!failed) http::read(stream, buffer, body, failed);
  throw_if_silent();
  if (failed == http::error::partial_message)
    throw Error(Error::kNoConnection,
                "the connection broke before the " + what + " was complete: " +
                    std::to_string(length - body.content_length_remaining().value_or(length)) + " of " +
                    std::to_string(length) + " bytes arrived");
  std::error_code not_renamed;
  if (!failed) body.get().body().file().close(failed);
  if (!failed) std::filesystem::rename(to.part, file, not_renamed);
  if (failed || not_renamed) throw Error(kNotPossible, "cannot write " + file);
}

}  // namespace coopdyn::client
