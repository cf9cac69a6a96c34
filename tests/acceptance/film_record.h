// The record of images: a hash of each, and block means that show how much another image differs.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "scheduler/plan/film_accumulator.h"

namespace penumbra {

/// Luminance of the blocks of a film, kBlocks a row and a column: mean and standard error of the mean.
struct FilmThumbnail {
  static constexpr int kBlocks = 3;
  std::vector<double> mean, error;
};

struct RecordedFilm {
  std::string hash;  ///< of all statistics and layers; or "refused", without a picture
  FilmThumbnail picture;
};

RecordedFilm record_film(const FilmAccumulator& film);

/// By the name of the image.
using FilmRecord = std::map<std::string, RecordedFilm>;

/// Empty where there is no file.
FilmRecord read_film_record(const std::filesystem::path& file);
void write_film_record(const std::filesystem::path& file, const FilmRecord& record);

/// How the picture `now` differs from the one before: the difference of the means of both images, that in
/// standard errors of their noise, and the same for the block that differs most, with its pixels. Both images
/// have the size width x height. The images need not be independent: equal seeds make z smaller than by
/// chance.
std::string difference_text(const FilmThumbnail& now, const FilmThumbnail& before, int width, int height);

}  // namespace penumbra
