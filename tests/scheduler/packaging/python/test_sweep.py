"""Sets of renders as a table."""

import penumbra
import pytest


def rows_of(table):
    return table if isinstance(table, list) else table.to_dict("records")


def test_all_combinations_are_rendered_once(cornell, tmp_path):
    def sweep():
        return rows_of(
            penumbra.sweep(
                cornell,
                {
                    "integrator": ["path_ems", "path_mats"],
                    "integrator.max_depth": [2],
                    "defines": {"resolution": [8, 16]},
                },
                repeat=2,
                spp=4,
                out=tmp_path,
            )
        )

    rows = sweep()
    assert len(rows) == 8 and {row["state"] for row in rows} == {"done"}
    assert {(row["integrator"], row["resolution"], row["seed"]) for row in rows} == {
        (integrator, size, seed) for integrator in ("path_ems", "path_mats") for size in (8, 16) for seed in (0, 1)
    }
    for row in rows:
        image = penumbra.read(row["file"])
        assert image.image.shape == (row["resolution"],) * 2 + (3,)
        assert image.statistics["settings"]["integrator"] == row["integrator"]
        assert image.statistics["settings"]["seed"] == row["seed"] and row["samples_per_pixel"] == 4
    assert {row["state"] for row in sweep()} == {"unchanged"}


def test_axes_are_checked(cornell):
    with pytest.raises(penumbra.UsageError, match="did you mean 'spp'"):
        penumbra.sweep(cornell, {"ssp": [1]})
    with pytest.raises(penumbra.UsageError, match="no values"):
        penumbra.sweep(cornell, {"spp": []})


def test_one_that_fails_is_a_row(cornell):
    rows = rows_of(
        penumbra.sweep(
            cornell, {"integrator": ["path", "photonmapper"]}, spp=1, target_error=0.5, defines={"resolution": 8}
        )
    )
    assert len(rows) == 2
