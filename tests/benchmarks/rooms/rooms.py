#!/usr/bin/env python3
"""Writes rooms like those of public scene sets, which Penumbra and Mitsuba 3 both read: OUT/NAME/scene.xml,
meshes, textures.

Work on the scenes that are called tuning; look at those that are held back only to see whether what was done
holds there.
The same names are the same files, on every machine.
"""

import argparse
import textwrap

import halls
import living
import vessels

# name: (what writes it, half, what it is about)
SCENES = {
    "bathroom": (living.bathroom, "tuning", "sun through a slab of glass, tiles with bumps, chrome, bottles"),
    "kitchen": (living.kitchen, "tuning", "hundreds of materials, 8 lights, window"),
    "bookshelf": (living.bookshelf, "tuning", "two bulbs within glass light hundreds of books"),
    "vitrines": (vessels.vitrines, "tuning", "art behind slabs and thin panes"),
    "haze": (vessels.haze, "tuning", "homogeneous haze in a room"),
    "door-ajar": (halls.door_ajar, "tuning", "indirect light alone"),
    "caustics": (vessels.caustics, "tuning", "smooth and rough glass under a small lamp"),
    "sculpture-hall": (halls.sculpture_hall, "tuning", "3 million triangles, open windows"),
    "metal-room": (halls.metal_room, "tuning", "textured two-sided rough metals and plastics"),
    "bedroom": (living.bedroom, "held_back", "sun through thin panes and lace, cloth"),
    "living-room": (living.living_room, "held_back", "1.3 million triangles, hundreds of materials, large panes"),
    "glass-of-water": (vessels.glass_of_water, "held_back", "nested glass and water in the sun"),
    "fogged-spot": (vessels.fogged_spot, "held_back", "a spot in fog"),
    "goblets": (vessels.goblets, "held_back", "caustics of smooth and rough glass, diamond, gold"),
    "thousand-lights": (halls.thousand_lights, "held_back", "1000 small lights of three kinds"),
    "jars": (vessels.jars, "held_back", "coloured media within smooth and rough boundaries"),
    "conservatory": (living.conservatory, "held_back", "thousands of masked leaves behind thin panes"),
    "office": (living.office, "held_back", "meshes that shine, normal maps, many materials"),
    "steel-kitchen": (living.steel_kitchen, "held_back", "brushed and dented steel, copper, lamps in a hood"),
    "attic": (living.attic, "held_back", "sun through one small window under a roof of beams"),
    "library-night": (living.library_night, "held_back", "a thousand books, ten shaded lamps, a weak moon"),
    "greenhouse": (living.greenhouse, "held_back", "sun through slabs of glass on masked leaves"),
    "glass-museum": (vessels.glass_museum, "held_back", "coloured, rough and cut glass under small lamps"),
    "aquarium": (vessels.aquarium, "held_back", "fish in a medium of water behind plates of glass"),
    "car-studio": (halls.car_studio, "held_back", "car paints under large lamps"),
    "tunnel": (halls.tunnel, "held_back", "500 lamps above wet asphalt"),
    "mirror-room": (halls.mirror_room, "held_back", "mirrors around coloured bulbs"),
    "ruins": (halls.ruins, "held_back", "3 million triangles, textures, sun"),
}


def main():
    table = "\n".join(f"  {name:16} {half:10} {about}" for name, (_, half, about) in SCENES.items())
    parser = argparse.ArgumentParser(description=textwrap.dedent(__doc__),
                                     epilog="scenes:\n" + table,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", metavar="OUT", help="folder to write into")
    parser.add_argument("--only", metavar="NAME", choices=SCENES, action="append", help="this scene (can be repeated)")
    arguments = parser.parse_args()
    for name in arguments.only or SCENES:
        SCENES[name][0](arguments.out).write()
        print(name, flush=True)


if __name__ == "__main__":
    main()
