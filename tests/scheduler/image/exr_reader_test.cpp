#include "scheduler/image/exr_reader.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <ImfStringAttribute.h>
#include <ImfTiledOutputFile.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>

#include "kernels/host/atomic_file.h"
#include "kernels/host/module.h"
#include "scheduler/image/image_files.h"
#include "scheduler/image/image_reader.h"
#include "tests/support/temporary_folder.h"

namespace penumbra {
namespace {

using Metadata = std::vector<std::pair<std::string, MetadataValue>>;

/// What OpenImageIO reads.
const ImageReader& general_reader() {
  static const auto module = load_module("libpenumbra_image_reader.so", "penumbra_image_reader");
  if (!module) throw std::runtime_error(module.error().message);
  return *static_cast<const ImageReader*>(*module);
}

Metadata of_picture(const Image& image) {
  Metadata all = image.metadata;
  std::erase_if(all,
                [](const auto& each) { return describes_file(each.first) && each.first != "compression"; });
  std::ranges::sort(all);
  return all;
}

void expect_as_openimageio(const std::filesystem::path& file) {
  const auto plain = read_plain_exr(file, true), header = read_plain_exr(file, false);
  const auto general = general_reader().read(file);
  ASSERT_TRUE(plain && header && general) << file;
  EXPECT_EQ(plain->data, general->data);
  EXPECT_EQ(plain->display, general->display);
  EXPECT_EQ(plain->channels, general->channels);
  EXPECT_EQ(plain->values, general->values);
  EXPECT_EQ(of_picture(*plain), of_picture(*general));
  EXPECT_EQ(plain->chromaticities, general->chromaticities);
  EXPECT_EQ(plain->camera, general->camera);
  EXPECT_EQ(header->channels, general->channels);
  EXPECT_EQ(of_picture(*header), of_picture(*general));
  EXPECT_TRUE(header->values.empty());
}

/// With channels in the order of names, which is not that of layers.
Image picture(std::vector<std::string> channels) {
  Image image;
  image.data = {-3, 2, 19, 7};
  image.display = {0, 0, 40, 30};
  image.channels = std::move(channels);
  for (std::size_t i = 0; i < image.pixels() * image.channels.size(); ++i)
    image.values.push_back(float(i % 97) * 0.37f - 3.0f);
  image.metadata = {{"penumbra:version", "0.1.0"},
                    {"penumbra:spp", 64},
                    {"penumbra:time", 0.25f},
                    {"penumbra:scale", 0.1},
                    {"cryptomatte/3ae39a5/name", "CryptoObject"}};
  image.chromaticities = kRec709;
  RowMatrix matrix{};
  for (std::size_t i = 0; i < matrix.size(); ++i) matrix[i] = float(i) + 0.5f;
  image.camera = {matrix, matrix};
  return image;
}

const std::vector<std::string> kChannels = {"R",
                                            "G",
                                            "B",
                                            "A",
                                            "Z",
                                            "albedo.R",
                                            "albedo.G",
                                            "albedo.B",
                                            "normal.X",
                                            "Y",
                                            "depth.Z",
                                            "depth.A",
                                            "samples.Y",
                                            "red.red",
                                            "b.green",
                                            "ViewLayer.A.R",
                                            "ViewLayer.A.B",
                                            "ViewLayer.A.g",
                                            "imag",
                                            "real",
                                            "AR",
                                            "RA",
                                            "BA",
                                            "Zback",
                                            "Depth",
                                            "c.Alpha",
                                            "c.BLUE",
                                            "c.Y",
                                            "c.a",
                                            "U",
                                            "Red"};

TEST(PlainExr, IsReadAsOpenImageIoReadsIt) {
  const TemporaryFolder folder;
  for (int compression = 0; compression <= int(ExrCompression::kDwab); ++compression)
    for (const bool half : {false, true}) {
      const auto bytes = encode_exr(picture(kChannels), {ExrCompression(compression), half});
      ASSERT_TRUE(bytes && write_file_atomically(folder / "a.exr", *bytes));
      expect_as_openimageio(folder / "a.exr");
    }
  Image grey = picture({"Y"});
  grey.chromaticities.reset();
  grey.camera.reset();
  ASSERT_TRUE(write_file_atomically(folder / "grey.exr", *encode_exr(grey)));
  expect_as_openimageio(folder / "grey.exr");
}

TEST(PlainExr, LeavesOtherFilesToOpenImageIo) {
  const TemporaryFolder folder;
  const auto write = [&](Imf::Header header, Imf::PixelType type) {
    header.channels().insert("R", Imf::Channel(type));
    std::vector<std::uint32_t> values(8 * 4, 0);
    Imf::FrameBuffer buffer;
    buffer.insert("R", Imf::Slice(type, reinterpret_cast<char*>(values.data()), 4, 32));
    const std::string name = (folder / "a.exr").string();
    if (header.hasTileDescription()) {
      Imf::TiledOutputFile file(name.c_str(), header);
      file.setFrameBuffer(buffer);
      file.writeTiles(0, file.numXTiles() - 1, 0, file.numYTiles() - 1);
    } else {
      Imf::OutputFile file(name.c_str(), header);
      file.setFrameBuffer(buffer);
      file.writePixels(4);
    }
    return folder / "a.exr";
  };
  EXPECT_TRUE(read_plain_exr(write(Imf::Header(8, 4), Imf::FLOAT), true));
  EXPECT_FALSE(read_plain_exr(write(Imf::Header(8, 4), Imf::UINT), true)) << "scaled";
  Imf::Header tiled(8, 4);
  tiled.setTileDescription({4, 4, Imf::ONE_LEVEL});
  EXPECT_FALSE(read_plain_exr(write(tiled, Imf::FLOAT), true));
  Imf::Header renamed(8, 4);
  renamed.insert("owner", Imf::StringAttribute("me"));
  EXPECT_FALSE(read_plain_exr(write(renamed, Imf::FLOAT), true)) << "OpenImageIO says Copyright";
  const auto file = write(Imf::Header(8, 4), Imf::FLOAT);
  std::filesystem::resize_file(file, std::filesystem::file_size(file) - 1);
  EXPECT_FALSE(read_plain_exr(file, true)) << "damaged";
  EXPECT_FALSE(read_plain_exr(folder / "none.exr", true));
  EXPECT_FALSE(read_plain_exr(folder.path(), true));
}

}  // namespace
}  // namespace penumbra
