// SPDX-License-Identifier: MIT
#include "server/yarp/target.h"

#include <algorithm>
#include <sstream>
#include <string>

#include "protocol/codec.h"
#include "server/naming/name_protocol.h"

namespace coopdyn {

YarpTarget ParseYarpTarget(const std::string& text) {
  YarpTarget target{.name = text, .carrier_words = "tcp", .qualifiers = {}, .problem = {}};
  if (const std::size_t colon = text.find(":/"); colon != std::string::npos && colon > 0) {
    target.carrier_words = text.substr(0, colon);
    target.name = NameInAddress(text);
  }
  if (!target.name.starts_with('/')) target.name.insert(0, 1, '/');
  std::istringstream words(target.carrier_words);
  std::string word;
  std::getline(words, word, '+');
  target.carrier = CarrierNamed(word);
  if (target.carrier == YarpCarrier::kOther) target.problem = "use tcp, fast_tcp, udp, text or text_ack";
  bool of_reader = false;
  while (std::getline(words, word, '+')) {
    of_reader |= word.starts_with("recv.");
    if (!of_reader || word.starts_with("send.") || word.starts_with("log."))
      target.problem = "no plug-in runs in the daemon; those of the reader are written +recv.NAME";
    if (const std::size_t dot = word.find('.'); dot != std::string::npos) word[dot] = ' ';
    target.qualifiers += " (" + word + ")";
  }
  // The asker must not inject messages to the reader in our name.
  if (!IsCleanUtf8(target.qualifiers) || std::any_of(target.qualifiers.begin(), target.qualifiers.end(),
                                                     [](unsigned char c) { return c < ' '; }))
    target.problem = "the words of a carrier are plain text";
  return target;
}

}  // namespace coopdyn
