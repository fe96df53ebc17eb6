// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include "drive/profile/bit_fields.h"

#include "common/text.h"

namespace cia402::drive {

std::string fieldsText(const BitFields& fields, std::uint64_t raw) {
  std::string text;
  for (const BitField& field : fields) {
    const unsigned width = field.high - field.low + 1;
    const std::uint64_t all = width >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << width) - 1;
    const std::uint64_t number = (raw >> field.low) & all;
    const auto word = field.words.find(number);
    append(text,
           field.name + " " +
               (width > 8 ? hexText(number, static_cast<int>((width + 3) / 4))
                          : std::to_string(number)) +
               (word == field.words.end() ? "" : " (" + word->second + ")"),
           ", ");
  }
  return text;
}

}  // namespace cia402::drive
