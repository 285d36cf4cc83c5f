// SPDX-License-Identifier: MIT
// Answers that no daemon gives: each is an Error that says what happened.
#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <thread>

#include "clients/cpp/page.h"
#include "tests/clients/cpp/error_of.h"

namespace coopdyn::client {
namespace {

namespace fs = std::filesystem;

/// Listens on a port of this machine; answers one connection with some bytes, then closes unless it is to
/// wait for the peer to do so.
class Answerer {
 public:
  explicit Answerer(std::string answer, bool waits = false) {
    listening_ = socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof(address);
    EXPECT_EQ(bind(listening_, reinterpret_cast<const sockaddr*>(&address), size), 0);
    EXPECT_EQ(listen(listening_, 1), 0);
    getsockname(listening_, reinterpret_cast<sockaddr*>(&address), &size);
    port_ = ntohs(address.sin_port);
    thread_ = std::thread([this, answer = std::move(answer), waits] {
      const int peer = accept(listening_, nullptr, nullptr);
      char bytes[4096];
      (void)!read(peer, bytes, sizeof(bytes));
      (void)!write(peer, answer.data(), answer.size());
      while (waits && read(peer, bytes, sizeof(bytes)) > 0) {
      }
      close(peer);
    });
  }
  ~Answerer() {
    thread_.join();
    close(listening_);
  }
  Answerer(const Answerer&) = delete;
  Answerer& operator=(const Answerer&) = delete;

  std::string server() const { return "127.0.0.1:" + std::to_string(port_); }

 private:
  int listening_ = -1, port_ = 0;
  std::thread thread_;
};

class Page : public testing::Test {
 protected:
  Page() : folder_(fs::temp_directory_path() / ("coopdyn-page-" + std::to_string(getpid()))) {
    fs::create_directory(folder_);
  }
  ~Page() override { fs::remove_all(folder_); }

  /// What a download from a page that answers so says. Leaves no half a file.
  Error DownloadFrom(const Answerer& page, double timeout_s = 30) {
    return ErrorOf([&] {
      Download(Address("127.0.0.1", "", "", 3), "http://" + page.server() + "/", "/x", file(), "recording",
               timeout_s);
    });
  }
  std::string file() const { return (folder_ / "x.run").string(); }
  std::ptrdiff_t files() const { return std::distance(fs::directory_iterator(folder_), {}); }

  fs::path folder_;
};

TEST_F(Page, GivesAWholeFile) {
  const Answerer page("HTTP/1.1 200 OK\r\ncontent-length: 5\r\n\r\nwhole and more");
  EXPECT_EQ(DownloadFrom(page).code(), 0);
  std::ifstream in(file());
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(in), {}), "whole");
  EXPECT_EQ(files(), 1);
}

TEST_F(Page, ThatIsNoneIsAnError) {
  for (const std::string said :
       {"", "SSH-2.0-x\r\n\r\n", "HTTP/1.1 200 OK\r\n\r\nno length", "HTTP/1.1 2x0 OK\r\n\r\n",
        "HTTP/1.1 200 OK\r\nContent-Length: 99999999999999999999\r\n\r\n", "HTTP/1.1 200 OK\r\nConte"}) {
    const Answerer page(said);
    EXPECT_EQ(DownloadFrom(page).code(), Error::kNoConnection) << said;
  }
  const Answerer page("HTTP/1.1 200 OK\r\n" + std::string(100000, 'x'));
  EXPECT_EQ(DownloadFrom(page).code(), Error::kNoConnection);
  EXPECT_EQ(files(), 0);
}

TEST_F(Page, ThatBreaksOffLeavesNoFile) {
  const Answerer page("HTTP/1.1 200 OK\r\nContent-Length: 10\r\n\r\n1234");
  const Error error = DownloadFrom(page);
  EXPECT_TRUE(Says(error, "-1 the connection broke")) << error.text();
  EXPECT_TRUE(Says(error, "4 of 10 bytes")) << error.text();
  EXPECT_EQ(files(), 0);
}

TEST_F(Page, ThatGivesNothingMoreIsNotWaitedForLong) {
  for (const std::string said : {"", "HTTP/1.1 200 OK\r\nContent-Length: 10\r\n\r\n1234",
                                 "HTTP/1.1 500 no\r\nContent-Length: 10\r\n\r\n1234"}) {
    const Answerer page(said, true);
    EXPECT_EQ(DownloadFrom(page, 0.05).code(), 11) << said;
  }
  EXPECT_EQ(files(), 0);
}

TEST_F(Page, ThatRefusesSaysWhy) {
  const Answerer none("HTTP/1.1 404 no\r\nContent-Length: 5\r\n\r\ngone\n");
  EXPECT_TRUE(Says(DownloadFrom(none), "10 no recording: gone"));
  const Answerer refused("HTTP/1.1 403 no\r\nContent-Length: 6\r\n\r\nsecret");
  EXPECT_TRUE(Says(DownloadFrom(refused), "5 no recording: secret"));
}

}  // namespace
}  // namespace coopdyn::client
