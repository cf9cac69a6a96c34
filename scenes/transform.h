// Affine transforms of scene files. Column vectors: p' = M p.
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <span>

#include "kernels/host/error.h"

namespace penumbra {

glm::dmat4 translation(glm::dvec3 offset);
glm::dmat4 scaling(glm::dvec3 factors);

/// Right-handed rotation by `degrees` about `axis`, of any non-zero length (Rodrigues' formula).
glm::dmat4 rotation(glm::dvec3 axis, double degrees);

/// Camera-to-world transform of a camera at `origin` that looks at `target` along its +z axis. `up` points
/// into the upper half of the image, and +x to its left. Without `up`, any direction across the view is used.
/// Errors: origin equals target; `up` is parallel to the view direction.
Expected<glm::dmat4> look_at(glm::dvec3 origin, glm::dvec3 target, std::optional<glm::dvec3> up);

/// A matrix from the 16 numbers of a 4×4 matrix, or the 9 numbers of its upper left 3×3 part, row by row.
/// Errors: another count; a last row other than 0 0 0 1 (perspective is not supported).
Expected<glm::dmat4> matrix_from_rows(std::span<const double> numbers);

/// Whether the transform is singular, or numerically so.
bool is_singular(const glm::dmat4& transform);

/// Whether the transform changes handedness.
bool is_mirror(const glm::dmat4& transform);

/// The common factor by which the transform scales lengths along its first `axes` axes (3: in space, 2: in
/// the xy-plane). Nothing if it is not a similarity there, within 1e-4, which allows for matrices written
/// with few digits.
std::optional<double> uniform_scale(const glm::dmat4& transform, int axes = 3);

/// The same frame with unit axes. Errors: the axes are not orthogonal.
Expected<glm::dmat4> without_scale(const glm::dmat4& transform);

/// The frame of a camera with this transform: the same frame with unit axes. If the axes are not orthogonal,
/// the view direction and the half plane of +y are kept. Errors: the transform is singular.
Expected<glm::dmat4> camera_frame(const glm::dmat4& to_world);

glm::dvec3 transform_point(const glm::dmat4& transform, glm::dvec3 point);
glm::dvec3 transform_vector(const glm::dmat4& transform, glm::dvec3 vector);

/// The transform of normals: the inverse transpose, up to a positive factor.
glm::dmat3 normal_matrix(const glm::dmat4& transform);

}  // namespace penumbra
