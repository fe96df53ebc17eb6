// Copyright 2026 the cia402_driver authors. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <linux/can.h>
#include <sys/socket.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "can/bus.h"
#include "can/frame.h"
#include "can/socketcan.h"
#include "can/wall_clock.h"

namespace cia402::can {

/// The system calls of a CAN_RAW socket. Errors are errno values, 0 is success.
class RawSocket {
 public:
  RawSocket();
  ~RawSocket();
  RawSocket(const RawSocket&) = delete;
  RawSocket& operator=(const RawSocket&) = delete;

  int open(int interface_index, const std::vector<ReceiveFilter>& filters, int receive_buffer,
           bool error_frames);
  void close();
  bool isOpen() const { return fd_ >= 0; }
  int fd() const { return fd_; }
  int interfaceIndex() const { return interface_index_; }
  int setFilters(const std::vector<ReceiveFilter>& filters);

  int send(const Frame& frame);

  /// The next frame of the batch read last.
  std::optional<ReceivedFrame> pop();
  /// Reads a batch of frames, to be popped before the next. EAGAIN: there are none.
  int read();
  /// The last read has taken everything there was.
  bool drained() const { return drained_; }
  /// Frames the kernel has lost for want of room in the receive buffer, since open().
  std::uint32_t overflows() const { return overflows_; }

 private:
  static constexpr std::size_t kBatch = 32;
  static constexpr std::size_t kControlSize = 64;  // a timespec and a counter with their headers
  struct alignas(cmsghdr) Control {
    std::array<char, kControlSize> bytes;
  };

  ReceivedFrame convert(std::size_t index);

  int fd_ = -1;
  int interface_index_ = 0;
  bool drained_ = true;
  std::uint32_t overflows_ = 0;
  std::size_t first_ = 0;
  std::size_t count_ = 0;
  WallClockMapping clock_;
  Time empty_after_batch_at_{};
  std::array<can_frame, kBatch> frames_{};
  std::array<iovec, kBatch> vectors_{};
  std::array<Control, kBatch> controls_{};
  std::array<mmsghdr, kBatch> messages_{};
};

}  // namespace cia402::can
