// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <string>
#include <string_view>

namespace cia402::bus {

/// A text in fixed memory, for values that cross from the bus thread without allocation. Longer
/// texts are cut and end in "...".
template <std::size_t N>
class FixedText {
  static_assert(N > 4, "room for the mark of a cut text");

 public:
  FixedText() = default;
  FixedText(const FixedText& other) { *this = other; }
  /// Copies what is used: most texts are empty most of the time.
  FixedText& operator=(const FixedText& other) {
    size_ = other.size_;
    if (this != &other) std::copy_n(other.data_.begin(), size_, data_.begin());
    return *this;
  }
  FixedText(std::string_view text) { assign(text); }  // NOLINT: implicit like std::string

  void assign(std::string_view text) {
    size_ = std::min(text.size(), N);
    std::copy_n(text.data(), size_, data_.begin());
    if (text.size() > N) std::fill_n(data_.begin() + (N - 3), 3, '.');
  }
  std::string_view view() const { return {data_.data(), size_}; }
  std::string str() const { return std::string(view()); }
  bool empty() const { return size_ == 0; }

 private:
  std::size_t size_ = 0;
  std::array<char, N> data_{};
};

template <std::size_t N>
bool operator==(const FixedText<N>& a, std::string_view b) {
  return a.view() == b;
}
template <std::size_t N>
bool operator!=(const FixedText<N>& a, std::string_view b) {
  return !(a == b);
}

}  // namespace cia402::bus
