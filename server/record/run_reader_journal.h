// SPDX-License-Identifier: MIT
// The rollback journal (`-journal`) that stays beside a recording whose program was killed while the file was
// made, or made plain at its end. SQLite undoes what had begun when the file is opened for writing. One
// thread.
#pragma once

#include <string>

namespace coopdyn {

/// Looks at the bytes, without SQLite: `file` begins as a recording does.
bool BeginsAsRecording(const std::string& file);

/// After a reader was refused: lets SQLite roll `file` back, if a journal lies beside it and both are of a
/// recorder. True: it has done so, and the journal is gone.
bool RollBack(const std::string& file);

}  // namespace coopdyn
