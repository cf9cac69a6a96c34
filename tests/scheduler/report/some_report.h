// A made-up report for tests of its files.
#pragma once

#include <cmath>

#include "scheduler/report/curve_builder.h"

namespace penumbra {

inline CurvePoint point_of(std::uint32_t spp, double seconds, double mse) {
  CurvePoint point;
  point.spp = spp;
  ImageResult image;
  image.file = "cells/a,b.exr";
  image.seconds = {0.01, 0.02, seconds, seconds + 0.04};
  image.render_seconds = {seconds};
  image.film_hash = "00ff";
  image.seed = 5;
  image.errors.mse = mse;
  image.errors.relative_mse = 2 * mse;
  image.errors.block_relative_mse = mse / 4;
  image.errors.bias = NAN;
  point.images = {image, image};
  point.seconds = image.seconds;
  point.errors = image.errors;
  point.squared = {mse, mse, 1e-9, 1e-8};
  point.relative = {2 * mse, 2 * mse, 1e-9, 1e-8};
  return point;
}

/// Two curves with MSE = 1 / T and 1 / T^2, and one of a peer.
inline ReportData some_report() {
  ReportData report;
  report.version = "1";
  report.host = "<host>";
  report.command_line = {"penumbra", "report", "a \"b\".xml"};
  report.cores = 4;
  SceneReport scene;
  scene.name = "s";
  scene.file = "a&b.xml";
  scene.targets = {{true, 0.5}, {false, 1e-9}};
  scene.reference.halves = {{"truth", "t.exr", 64, 1.5}};
  for (const double slope : {1.0, 2.0}) {
    ErrorCurve curve;
    curve.name.label = slope == 1 ? "one, \"quoted\"" : "two";
    curve.name.sampler = slope == 1 ? "independent" : "sobol";
    for (const std::uint32_t spp : {1u, 2u, 4u, 8u})
      curve.points.push_back(point_of(spp, spp, std::pow(spp, -slope)));
    scene.curves.push_back(curve);
  }
  ErrorCurve peer;
  peer.name.label = "peer";
  peer.name.peer = true;
  peer.points = {point_of(0, 3, 0.3)};
  scene.curves.push_back(peer);
  for (ErrorCurve& curve : scene.curves) finish_curve(report, scene.targets, curve);
  scene.remarks = {"<script>"};
  report.scenes = {scene};
  return report;
}

}  // namespace penumbra
