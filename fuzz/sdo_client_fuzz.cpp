// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#include <cstdint>
#include <memory>
#include <vector>

#include "can/pacer.h"
#include "canopen/sdo/client.h"
#include "input.h"

// The SDO client with any frames at any times, in every phase of every kind of transfer. Half of
// the frames are made from the client's own last request, as a server might answer it, for random
// bytes would hardly ever get beyond the first phase. Each transfer must end, at the latest when
// the server falls silent, exactly once; and what was uploaded is no longer than what was received.
namespace cia402::fuzz {
namespace {

using namespace canopen;

constexpr NodeId kNode = 5;
constexpr std::uint32_t kAnswerId = 0x585;
constexpr std::size_t kShortUpload = 20;

/// Keeps the last request and its number, and what a block upload has brought so far.
struct Requests : can::Sink {
  bool send(const can::Frame& frame) override {
    last = frame;
    ++count;
    const std::uint8_t command = frame.data[0];
    if (command == 0xA3 || command == 0xA2) sequence = 0;  // a sub-block begins
    if ((command & 0xE3U) == 0xA0U) uploaded.clear();      // an upload begins
    require(frame.id == 0x605 && frame.size == 8, "a request is a frame of 8 bytes on 605h");
    return count % 50 != 49;  // the queue is full now and then
  }
  can::Frame last;
  std::uint64_t count = 0;
  std::uint8_t sequence = 0;  ///< of the last segment of a sub-block of an upload
  Bytes uploaded;
};

/// CRC of CiA 301, 7.2.4.3.16: polynomial x^16 + x^12 + x^5 + 1, from 0.
std::uint16_t checksum(const Bytes& data, std::size_t size) {
  std::uint32_t crc = 0;
  for (std::size_t i = 0; i < size; ++i) {
    crc ^= std::uint32_t{data[i]} << 8U;
    for (int bit = 0; bit < 8; ++bit) crc = (crc & 0x8000U) != 0 ? crc << 1U ^ 0x1021U : crc << 1U;
  }
  return static_cast<std::uint16_t>(crc);
}

/// What a server of block transfers would say next, right more often than not.
can::Frame blockAnswer(Requests& requests, Input& input) {
  can::Frame frame = requests.last;
  frame.id = kAnswerId;
  frame.size = 8;
  const std::uint8_t shape = input.byte();
  switch (shape % 4) {
    case 0:  // a segment, the last one or not
      frame.data[0] = static_cast<std::uint8_t>(++requests.sequence | (shape & 0x80U));
      for (std::size_t i = 1; i < 8; ++i) {
        frame.data[i] = input.byte();
        requests.uploaded.push_back(frame.data[i]);
      }
      break;
    case 1:  // a sub-block has come
      frame.data = {0xA2, static_cast<std::uint8_t>(requests.last.data[0] & 0x7FU), input.byte()};
      break;
    case 2: {  // the end: bytes of the last segment that do not count, and the checksum
      const unsigned unused = shape / 4 % 8;
      const std::size_t size = requests.uploaded.size();
      const std::uint16_t crc = checksum(requests.uploaded, size < unused ? 0 : size - unused);
      frame.data = {static_cast<std::uint8_t>(0xC1U | unused << 2U),
                    static_cast<std::uint8_t>(crc & 0xFFU), static_cast<std::uint8_t>(crc >> 8U)};
      break;
    }
    default:  // the beginning, of an upload or a download
      frame.data[0] = requests.last.data[0] < 0xC0 ? 0xC6 : 0xA4;
      frame.data[4] = input.byte();
      for (std::size_t i = 5; i < 8; ++i) frame.data[i] = 0;
  }
  return frame;
}

/// A plausible answer: the last request's object with a command of any kind.
can::Frame answer(const Requests& requests, Input& input) {
  static constexpr std::uint8_t kCommands[] = {
      0x60, 0x20, 0x30, 0x41, 0x40, 0x43, 0x4B, 0x4F, 0x00, 0x10, 0x01, 0x0F, 0x1F, 0x80,
      0xA0, 0xA1, 0xA2, 0xA4, 0xC0, 0xC2, 0xC4, 0xC6, 0xC1, 0xC5, 0xDD, 0x81, 0x82, 0xFF};
  can::Frame frame = requests.last;
  frame.id = kAnswerId;
  frame.size = 8;
  const std::uint8_t choice = input.byte();
  frame.data[0] = choice < 0xE0 ? kCommands[choice % sizeof kCommands] : input.byte();
  if (choice % 3 == 0) {
    for (std::size_t i = 4; i < 8; ++i) frame.data[i] = input.byte();
  } else if (choice % 3 == 1) {
    frame.data[4] = input.byte();
    frame.data[5] = frame.data[6] = frame.data[7] = 0;
  } else {
    for (std::size_t i = 1; i < 8; ++i) frame.data[i] = input.byte();
  }
  return frame;
}

SdoOptions readOptions(Input& input) {
  SdoOptions options;
  options.timeout = std::chrono::milliseconds(1 + input.byte());
  const std::uint8_t shape = input.byte();
  using Block = SdoOptions::Block;
  static constexpr Block kBlocks[] = {Block::automatic, Block::always, Block::never};
  options.retries = shape % 3;
  options.block = kBlocks[shape / 4 % 3];
  if ((shape & 0x40U) != 0) options.longest_upload = kShortUpload;
  if ((shape & 0x80U) != 0) options.block_threshold = 4;
  return options;
}

void start(SdoClient& client, Input& input, std::vector<SdoTicket>& tickets) {
  const std::uint8_t kind = input.byte();
  const ObjectId object{static_cast<std::uint16_t>(0x1000 + kind % 4), 0};
  const SdoOptions options = readOptions(input);
  if ((kind & 0x80U) == 0) {
    tickets.push_back(client.upload(object, "fuzz", options));
  } else {
    Bytes data = input.bytes(40);
    if ((kind & 0x40U) != 0) data.resize(data.size() * 50);
    tickets.push_back(client.download(object, data, "fuzz", options));
  }
}

void check(const std::vector<SdoTicket>& tickets, std::uint64_t frames) {
  for (const SdoTicket& ticket : tickets) {
    if (ticket->direction() == SdoTransfer::Direction::upload && ticket->ok()) {
      require(ticket->data().size() <= 8 * frames, "an upload holds what was received, not more");
    }
    require(ticket->done() || ticket->failure() == SdoTransfer::Failure::none,
            "a failure comes with the end");
    require(!ticket->done() || ticket->ok() || !ticket->message().empty(), "a failure is told");
  }
}

}  // namespace
}  // namespace cia402::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace cia402;
  if (size > 4096) return 0;
  fuzz::Input input(data, size);
  fuzz::Requests requests;
  const canopen::SdoOptions defaults = fuzz::readOptions(input);
  // Half of them at 1 Mbit/s, with the segments of a block held back for the wire.
  const bool paced = (size & 1U) != 0;
  can::Pacer pacer(requests, 1e6);
  can::Sink& sink = paced ? static_cast<can::Sink&>(pacer) : requests;
  canopen::SdoClient client(fuzz::kNode, sink, defaults, {}, paced ? &pacer : nullptr);
  std::vector<canopen::SdoTicket> tickets;
  std::uint64_t frames = 0;
  Time now{};
  while (!input.empty()) {
    const std::uint8_t action = input.byte();
    pacer.setTime(now);
    if (action < 0x30) {
      if (tickets.size() < 20) fuzz::start(client, input, tickets);
      client.tick(now);
    } else if (action < 0x60) {
      now += std::chrono::milliseconds(input.byte());
      client.tick(now);
    } else if (action < 0x90) {
      client.receive(fuzz::answer(requests, input), now);
      ++frames;
    } else if (action < 0xC0) {
      client.receive(fuzz::blockAnswer(requests, input), now);
      ++frames;
    } else if (action < 0xFC) {
      client.receive(input.frame(action < 0xF0 ? fuzz::kAnswerId : input.word() & 0x7FFU), now);
      ++frames;
    } else {
      client.cancelAll("fuzz");
      if (action == 0xFF) client.serverRestarted();
    }
    fuzz::check(tickets, frames);
  }
  // The server is silent from here on: deadlines alone must end everything.
  for (int steps = 0; !client.idle(); ++steps) {
    fuzz::require(steps < 100'000, "everything ends when the server is silent");
    const Time deadline = client.nextDeadline();
    fuzz::require(deadline != kNever, "who waits has a deadline");
    if (deadline > now) now = deadline;
    pacer.setTime(now);
    client.tick(now);
  }
  fuzz::check(tickets, frames);
  for (const canopen::SdoTicket& ticket : tickets) {
    fuzz::require(ticket->done(), "each transfer ends");
    fuzz::require(ticket.use_count() == 1, "the client forgets what has ended");
  }
  return 0;
}
