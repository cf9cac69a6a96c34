# SPDX-License-Identifier: GPL-3.0-or-later
"""Receives the tiles that `penumbra render --tev HOST:PORT` sends, into an image.

Of tev's protocol (https://github.com/Tom94/tev, README) it takes what Penumbra sends: packets of a 4-byte length, which
counts itself, an operation of one byte and its arguments. Numbers are little-endian, texts end with a 0 byte.
"""

import socket
import struct
import threading

import numpy as np

CREATE_IMAGE = 4
UPDATE_IMAGE = 6  # the third version of the operation: channels with offsets and strides
CHANNELS = ("R", "G", "B")
LONGEST_PACKET = 1 << 28  # bytes; a tile of 2048 x 2048 pixels has 48 MiB
ACCEPT_INTERVAL = 0.2  # seconds between looks at whether to end


class TileStream:
    """An image that fills as tiles arrive, on a port of this machine. Rows go down, as in files."""

    def __init__(self):
        self._server = socket.create_server(("127.0.0.1", 0))
        self._server.settimeout(ACCEPT_INTERVAL)
        self._lock = threading.Lock()
        self._image = None  # (height, width, 4): alpha is 1 where tiles have arrived, else 0
        self._version = 0
        self._ends = threading.Event()
        self._has_all = threading.Event()
        self.problem = None  # why the stream has ended early; the render goes on
        self._thread = threading.Thread(target=self._receive, daemon=True)
        self._thread.start()

    @property
    def address(self):
        """For --tev."""
        return "127.0.0.1:%d" % self._server.getsockname()[1]

    @property
    def version(self):
        """Changes with each tile; 0 before the first."""
        with self._lock:
            return self._version

    def image(self, crop=None):
        """A copy of the pixels (left, upper, right, lower), or of all: (height, width, 4), opaque, and nothing where no
        tile has arrived. None before the image is known."""
        with self._lock:
            if self._image is None:
                return None
            left, upper, right, lower = crop or (0, 0, self._image.shape[1], self._image.shape[0])
            return self._image[upper:lower, left:right].copy()

    def image_over(self, background):
        """The image; where no tile has arrived the background (rows, columns, 4), scaled to its size."""
        image = self.image()
        if image is None or background is None:
            return image
        rows = np.arange(image.shape[0]) * background.shape[0] // image.shape[0]
        columns = np.arange(image.shape[1]) * background.shape[1] // image.shape[1]
        return np.where(image[..., 3:] > 0, image, background[rows[:, None], columns])

    def drain(self, seconds=2.0):
        """Waits until all has arrived that a renderer has sent which has ended."""
        self._has_all.wait(seconds)

    def close(self):
        """Ends the stream."""
        self._ends.set()
        self._thread.join()
        self._server.close()

    def _receive(self):
        while not self._ends.is_set():
            try:
                connection, _ = self._server.accept()
            except TimeoutError:
                continue
            except OSError as error:
                self.problem = str(error)
                return
            with connection:
                connection.settimeout(ACCEPT_INTERVAL)
                try:
                    self._receive_packets(connection)
                except (OSError, ValueError, struct.error) as error:
                    self.problem = f"the tiles do not arrive any further: {error}"
            self._has_all.set()

    def _receive_packets(self, connection):
        while (head := self._receive_bytes(connection, 4)) is not None:
            length = struct.unpack("<I", head)[0]
            if not 5 <= length <= LONGEST_PACKET:
                raise ValueError(f"a packet of {length} bytes")
            packet = self._receive_bytes(connection, length - 4)
            if packet is None:
                return
            self._take(packet)

    def _receive_bytes(self, connection, count):
        """So many bytes; None at the end of the stream."""
        data = bytearray(count)
        view = memoryview(data)
        while view:
            try:
                received = connection.recv_into(view)
            except TimeoutError:
                if self._ends.is_set():
                    return None
                continue
            if received == 0:
                return None
            view = view[received:]
        return data

    def _take(self, packet):
        reader = _Reader(packet)
        operation = reader.number("B")
        reader.number("B")  # whether the viewer's window shall come to the front
        reader.text()  # the image's name
        if operation == CREATE_IMAGE:
            width, height = reader.number("i"), reader.number("i")
            if width <= 0 or height <= 0:
                raise ValueError(f"an image of {width} x {height} pixels")
            with self._lock:
                self._image = np.zeros((height, width, 4), np.float32)
        elif operation == UPDATE_IMAGE:
            channels = reader.texts()
            x, y, width, height = (reader.number("i") for _ in range(4))
            offsets = [reader.number("q") for _ in channels]
            strides = [reader.number("q") for _ in channels]
            values = np.frombuffer(packet, "<f4", offset=reader.offset)
            self._take_tile(channels, (x, y, width, height), offsets, strides, values)

    def _take_tile(self, channels, area, offsets, strides, values):
        x, y, width, height = area
        count = width * height
        with self._lock:
            if self._image is None:
                raise ValueError("a tile without an image")
            if x < 0 or y < 0 or x + width > self._image.shape[1] or y + height > self._image.shape[0]:
                raise ValueError(f"a tile outside of the image: {area}")
            for name, offset, stride in zip(channels, offsets, strides):
                if name in CHANNELS:
                    channel = values[offset:offset + stride * (count - 1) + 1:stride]
                    self._image[y:y + height, x:x + width, CHANNELS.index(name)] = channel.reshape(height, width)
            self._image[y:y + height, x:x + width, 3] = 1
            self._version += 1


class _Reader:
    """Reads the arguments of a packet."""

    def __init__(self, packet):
        self._packet = packet
        self.offset = 0

    def number(self, kind):
        value, = struct.unpack_from("<" + kind, self._packet, self.offset)
        self.offset += struct.calcsize("<" + kind)
        return value

    def text(self):
        end = self._packet.index(0, self.offset)
        value = self._packet[self.offset:end].decode("utf-8", "replace")
        self.offset = end + 1
        return value

    def texts(self):
        return [self.text() for _ in range(self.number("i"))]
