// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace cia402::drive {

enum class NoticeKind : std::uint8_t {
  error,
  warning,      ///< stops nothing
  information,  ///< good to know
};

struct Notice {
  std::string text;  ///< a sentence
  NoticeKind kind = NoticeKind::error;
};

/// What an axis did by itself and people are told of, and why a procedure that runs must fail.
class Notices {
 public:
  /// So many are kept until others come: more than an axis has to tell between two looks at it.
  static constexpr std::uint32_t kKept = 16;

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
  /// Grows with each notice.
  const std::uint32_t& count() const { return count_; }
  /// A notice by its number: count() is that of the last one, of 0 the text is empty.
  /// @param number above count() - kKept
  const Notice& at(std::uint32_t number) const { return kept_[number % kKept]; }

 private:
  bool isNew(const std::string& text);
  void add(std::string text, NoticeKind kind);

  std::string failure_;

  std::vector<std::string> once_;  ///< of warnOnce() and informOnce()
  std::uint32_t count_ = 0;
  std::array<Notice, kKept> kept_;
};

}  // namespace cia402::drive
