// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace cia402::drive {

enum class NoticeKind : std::uint8_t {
  error,
  warning,      ///< stops nothing
  information,  ///< good to know
};

/// What an axis did by itself and people are told of, and why a procedure that runs must fail.
class Notices {
 public:
  void notify(std::string text);
  /// A notice of what stops nothing.
  void warn(std::string text);
  /// The same, told once.
  void warnOnce(std::string text);
  /// Something good to know, told once.
  void informOnce(std::string text);
  /// The axis fell out of what it was doing: a procedure that runs must fail for this reason.
  /// @param tell people are told as well
  void fail(std::string text, bool tell = true);

  bool failed() const { return !failure_.empty(); }
  /// Why a procedure must fail; empty: it need not. It is forgotten by this.
  std::string takeFailure();
  /// The last notice, a sentence.
  const std::string& text() const { return text_; }
  NoticeKind kind() const { return kind_; }
  /// Grows with each notice.
  const std::uint32_t& count() const { return count_; }

 private:
  std::string failure_, text_;
  bool isNew(const std::string& text);

  std::vector<std::string> once_;  ///< of warnOnce() and informOnce()
  std::uint32_t count_ = 0;
  NoticeKind kind_ = NoticeKind::error;
};

}  // namespace cia402::drive
