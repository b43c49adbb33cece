#include "document.h"

#include <cstring>
#include <fstream>
#include <iterator>

#include <gtest/gtest.h>
#include <sys/stat.h>

#include "gltf/test_models.h"
#include "model.h"
#include "output_file.h"
#include "save_document.h"
#include "uri.h"

namespace applique {
namespace {

const std::string minimal = R"({"asset":{"version":"2.0"}})";

std::string error_of(const std::vector<std::uint8_t>& bytes) {
  const auto document = parse_document(bytes, "m.glb", "");
  return document ? "" : document.error().message;
}

TEST(Uri, DecodesPercentsAndData) {
  EXPECT_EQ(percent_decode("a%20b%2Fc%zz%4"), "a b/c%zz%4");
  EXPECT_EQ(percent_decode(percent_encode("Mönch & Söhne 100%.png")), "Mönch & Söhne 100%.png");
  const auto bytes = decode_data_uri("data:application/octet-stream;base64,AAEC/w==", "buffer 0");
  ASSERT_TRUE(bytes);
  EXPECT_EQ(*bytes, (std::vector<std::uint8_t>{0, 1, 2, 255}));
  EXPECT_EQ(decode_data_uri("data:,a%20b", "buffer 0").value(), (std::vector<std::uint8_t>{'a', ' ', 'b'}));
  EXPECT_EQ(decode_data_uri("data:;base64,A*==", "buffer 0").error().message,
            "buffer 0: its data URI is not valid base64");
  EXPECT_TRUE(is_relative_uri("textures/a:b.png"));
  EXPECT_FALSE(is_relative_uri("http://example.com/a.png"));
  EXPECT_FALSE(is_relative_uri("/etc/passwd"));
}

TEST(Glb, SaysWhatIsWrongWithTheContainer) {
  auto glb = make_glb(minimal, {1, 2, 3, 4});
  EXPECT_EQ(error_of(glb), "");
  auto wrong_version = glb;
  wrong_version[4] = 1;
  EXPECT_NE(error_of(wrong_version).find("GLB version 1; only version 2 is read"), std::string::npos);
  auto wrong_length = glb;
  wrong_length[8] ^= 4;
  EXPECT_NE(error_of(wrong_length).find("the header says"), std::string::npos);
  auto wrong_chunk = glb;
  wrong_chunk[15] = 0x7F;
  EXPECT_NE(error_of(wrong_chunk).find("chunk 0 says"), std::string::npos);
  auto no_json = glb;
  no_json[16] = 'X';
  EXPECT_NE(error_of(no_json).find("the first chunk is not JSON"), std::string::npos);
  EXPECT_NE(error_of(make_glb("[1]")).find("its JSON is not an object"), std::string::npos);
  EXPECT_EQ(error_of(make_glb(R"({"asset":{"version";"2.0"}})")),
            "'m.glb': its JSON cannot be parsed: line 1, column 20: found ';' where ':' is expected");
  EXPECT_NE(error_of({'P', 'K', 3, 4}).find("neither a GLB"), std::string::npos);
}

TEST(Glb, KeepsUnknownChunks) {
  auto glb = make_glb(minimal, {1, 2, 3, 4});
  const std::vector<std::uint8_t> extra = {4, 0, 0, 0, 'Z', 'Z', 'Z', 0, 9, 8, 7, 6};
  glb.insert(glb.end(), extra.begin(), extra.end());
  glb[8] = static_cast<std::uint8_t>(glb.size());
  const auto document = parse_document(glb, "m.glb", "");
  ASSERT_TRUE(document) << document.error().message;
  const TemporaryFolder folder;
  ASSERT_TRUE(save_document(*document, folder / "out.glb"));
  EXPECT_EQ(read_file(folder / "out.glb").value(), glb);
}

/// A GLB of one textured triangle, as small as it gets.
std::vector<std::uint8_t> small_glb() {
  const std::string json = R"({"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
    "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
    "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}],
    "bufferViews":[{"buffer":0,"byteLength":36}],"buffers":[{"byteLength":36}]})";
  std::vector<std::uint8_t> chunk(36);
  const std::array<float, 9> positions = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  std::memcpy(chunk.data(), positions.data(), 36);
  return make_glb(json, chunk);
}

TEST(Glb, EveryTruncationIsTurnedDown) {
  const auto glb = small_glb();
  ASSERT_TRUE(decode_model(parse_document(glb, "m.glb", "").value()));
  for (std::size_t size = 0; size < glb.size(); ++size) {
    const std::vector<std::uint8_t> cut(glb.begin(), glb.begin() + static_cast<std::ptrdiff_t>(size));
    EXPECT_FALSE(parse_document(cut, "m.glb", "").has_value()) << size << " bytes";
    // The same with a header that agrees, so that what lies behind it is cut.
    if (size < 12) continue;
    auto agreeing = cut;
    for (int k = 0; k < 4; ++k) agreeing[8 + k] = static_cast<std::uint8_t>(size >> (8 * k));
    const auto document = parse_document(agreeing, "m.glb", "");
    if (!document) continue;
    EXPECT_FALSE(decode_model(*document).has_value()) << size << " bytes";
  }
}

TEST(Glb, NoChangedByteCrashes) {
  const auto glb = small_glb();
  for (std::size_t at = 0; at < glb.size(); ++at)
    for (const int value : {0x00, 0x31, 0x39, 0x7F, 0xFF}) {
      auto changed = glb;
      changed[at] = static_cast<std::uint8_t>(value);
      const auto document = parse_document(changed, "m.glb", "");
      if (!document) {
        EXPECT_FALSE(document.error().message.empty());
      } else if (const auto model = decode_model(*document); !model) {
        EXPECT_FALSE(model.error().message.empty());
      }
    }
}

TEST(Corpus, EveryMalformedModelLoadsOrSaysWhyNot) {
  if (test_data().empty()) GTEST_SKIP() << no_test_data;
  const auto paths = models_below(test_data() / "malformed");
  ASSERT_GT(paths.size(), 100u);
  for (const auto& path : paths) {
    const auto model = load_model(path);
    if (model) {
      EXPECT_FALSE(model->parts.empty()) << path;
      continue;
    }
    const Error& error = model.error();
    EXPECT_NE(error.message.find('\''), std::string::npos) << path << ": " << error.message;
    EXPECT_TRUE(error.code == ErrorCode::model_invalid || error.code == ErrorCode::model_unsupported ||
                error.code == ErrorCode::file_unreadable)
        << path << ": " << error.message;
  }
}

TEST(Corpus, TruncatedModelsAreTurnedDown) {
  if (test_data().empty()) GTEST_SKIP() << no_test_data;
  // Draco and meshopt streams among them: the container's length is put right, the streams are cut.
  for (const char* name : {"Box_Draco.glb", "BoxVertexColors.glb", "pirate_meshopt.glb"}) {
    const auto glb = read_file(test_data() / "gltf" / name).value();
    const std::size_t step = 1 + glb.size() / 400;
    for (std::size_t size = 0; size < glb.size(); size += step) {
      const std::vector<std::uint8_t> cut(glb.begin(), glb.begin() + static_cast<std::ptrdiff_t>(size));
      EXPECT_FALSE(parse_document(cut, name, "").has_value()) << name << ", " << size;
    }
  }
}

TEST(Corpus, NoChangedByteOfACompressedModelCrashes) {
  if (test_data().empty()) GTEST_SKIP() << no_test_data;
  for (const char* name : {"Box_Draco.glb", "pirate_meshopt.glb"}) {
    const auto glb = read_file(test_data() / "gltf" / name).value();
    const std::size_t step = 1 + glb.size() / 150;
    for (std::size_t at = 12; at < glb.size(); at += step) {
      auto changed = glb;
      changed[at] = static_cast<std::uint8_t>(changed[at] ^ 0x55);
      const auto document = parse_document(changed, name, "");
      if (!document) continue;
      const auto model = decode_model(*document);
      EXPECT_TRUE(model || !model.error().message.empty());
    }
  }
}

/// All bytes behind the document's buffers and images.
std::vector<std::vector<std::uint8_t>> all_bytes(const Document& document) {
  std::vector<std::vector<std::uint8_t>> all;
  const Buffers buffers = read_buffers(document).value();
  for (const auto& bytes : buffers.bytes) all.emplace_back(bytes.begin(), bytes.end());
  return all;
}

std::vector<std::vector<std::uint8_t>> all_images(const Document& document) {
  std::vector<std::vector<std::uint8_t>> all;
  for (std::size_t i = 0; i < count_of(document, "images"); ++i)
    all.push_back(read_image_bytes(document, i).value_or(std::vector<std::uint8_t>()));
  return all;
}

TEST(SaveDocument, KeepsJsonAndBytesInTheSameFormat) {
  if (test_data().empty()) GTEST_SKIP() << no_test_data;
  int count = 0;
  for (const auto& path : good_models()) {
    const auto document = load_document(path);
    ASSERT_TRUE(document) << path;
    ASSERT_TRUE(check_document(*document)) << path;
    const TemporaryFolder folder;
    const auto output = folder / path.filename().string();
    const auto saved = save_document(*document, output);
    ASSERT_TRUE(saved) << path << ": " << saved.error().message;
    const auto again = load_document(output);
    ASSERT_TRUE(again) << again.error().message;
    EXPECT_EQ(again->json.dump(), document->json.dump()) << path;
    EXPECT_EQ(again->binary_chunk, document->binary_chunk) << path;
    EXPECT_EQ(all_bytes(*again), all_bytes(*document)) << path;
    EXPECT_EQ(all_images(*again), all_images(*document)) << path;
    ++count;
  }
  EXPECT_GT(count, 50);
}

TEST(SaveDocument, KeepsGeometryAndImagesInTheOtherFormat) {
  if (test_data().empty()) GTEST_SKIP() << no_test_data;
  for (const auto& path : good_models()) {
    const auto model = load_model(path);
    if (!model) continue;
    const TemporaryFolder folder;
    const auto output = folder / (model->document.is_glb ? "out.gltf" : "out.glb");
    const auto saved = save_document(model->document, output);
    ASSERT_TRUE(saved) << path << ": " << saved.error().message;
    const auto again = load_model(output);
    ASSERT_TRUE(again) << path << ": " << again.error().message;
    EXPECT_EQ(all_images(again->document), all_images(model->document)) << path;
    ASSERT_EQ(again->parts.size(), model->parts.size());
    for (std::size_t i = 0; i < model->parts.size(); ++i) {
      EXPECT_EQ(again->parts[i].positions, model->parts[i].positions) << path;
      EXPECT_EQ(again->parts[i].uvs, model->parts[i].uvs) << path;
      EXPECT_EQ(again->parts[i].triangles, model->parts[i].triangles) << path;
    }
  }
}

TEST(SaveDocument, WritesNothingWhereItCannot) {
  const auto document = parse_document(small_glb(), "m.glb", "").value();
  const TemporaryFolder folder;
  const auto wrong_name = save_document(document, folder / "out.obj");
  ASSERT_FALSE(wrong_name);
  EXPECT_EQ(wrong_name.error().code, ErrorCode::output_unwritable);
  EXPECT_NE(wrong_name.error().message.find("ends in .glb or .gltf"), std::string::npos);
  const auto no_folder = save_document(document, folder / "none/out.glb");
  ASSERT_FALSE(no_folder);
  EXPECT_EQ(no_folder.error().code, ErrorCode::output_unwritable);
  EXPECT_NE(no_folder.error().message.find("none"), std::string::npos);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(SaveDocument, LeavesNoTemporaryFileBehind) {
  const auto document = parse_document(small_glb(), "m.glb", "").value();
  const TemporaryFolder folder;
  ASSERT_TRUE(save_document(document, folder / "out.gltf"));
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder.path()))
    names.push_back(entry.path().filename());
  std::sort(names.begin(), names.end());
  EXPECT_EQ(names, (std::vector<std::string>{"out.bin", "out.gltf"}));
}

/// As exporters name them alike, files of two models meet in one folder; the second gets a name of its own.
TEST(SaveDocument, LeavesFilesOfOtherModelsAlone) {
  const TemporaryFolder folder;
  for (const char* name : {"a", "b"}) {
    std::filesystem::create_directories(folder / name);
    write_text(folder / name / "skin.png", name);
    write_text(folder / name / "scene.gltf", R"({"asset":{"version":"2.0"},"images":[{"uri":"skin.png"}]})");
  }
  std::filesystem::create_directories(folder / "out");
  for (int again = 0; again < 2; ++again)
    for (const std::string name : {"a", "b"}) {
      const auto document = load_document(folder / name / "scene.gltf").value();
      ASSERT_TRUE(save_document(document, folder / "out" / (name + ".gltf")));
    }
  for (const std::string name : {"a", "b"}) {
    const auto saved = load_document(folder / "out" / (name + ".gltf")).value();
    const auto bytes = read_image_bytes(saved, 0).value();
    EXPECT_EQ(std::string(bytes.begin(), bytes.end()), name);
  }
}

/// The files of a .gltf are put in place together or not at all.
TEST(SaveDocument, LeavesWhatWasThereWhereItFails) {
  const TemporaryFolder folder;
  write_text(folder / "m.bin", "before");
  const std::string text = "after";
  const std::span bytes{reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
  // The second name is allowed, but leaves no room for that of a temporary file.
  const std::vector<OutputFile> files = {{folder / "m.bin", bytes}, {folder / std::string(254, 'x'), bytes}};
  EXPECT_FALSE(write_files(files));
  std::ifstream file(folder / "m.bin");
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(file), {}), "before");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);
}

TEST(WriteFile, ReplacesNoPipeAndFollowsLinks) {
  const TemporaryFolder folder;
  const auto pipe = folder / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_FALSE(write_file(pipe, "text"));
  EXPECT_TRUE(std::filesystem::is_fifo(pipe));
  write_text(folder / "real", "before");
  std::filesystem::create_symlink("real", folder / "link");
  EXPECT_TRUE(write_file(folder / "link", "after"));
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "link"));
  std::ifstream file(folder / "real");
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(file), {}), "after");
}

TEST(SaveDocument, BringsFilesFromOutsideTheFolderAlong) {
  const TemporaryFolder folder;
  std::filesystem::create_directories(folder / "model");
  std::filesystem::create_directories(folder / "out");
  write_text(folder / "shared skin.png", "not really a PNG");
  write_text(folder / "model/m.gltf",
             R"({"asset":{"version":"2.0"},"images":[{"uri":"../shared%20skin.png"}]})");
  const auto document = load_document(folder / "model/m.gltf").value();
  ASSERT_TRUE(save_document(document, folder / "out/m.gltf"));
  const auto again = load_document(folder / "out/m.gltf").value();
  EXPECT_EQ(again.json["images"][0]["uri"], "shared%20skin.png");
  EXPECT_EQ(read_image_bytes(again, 0).value(), read_image_bytes(document, 0).value());
}

}  // namespace
}  // namespace applique
