"""Converts the mesh of an Abaqus or CalculiX input file to Gmsh's MSH 4.1: python3 inp_to_msh.py part.inp part.msh

Element sets named by *SOLID SECTION become groups of elements, *SURFACE and *NSET become boundaries. Needs no packages.
"""

import sys
from pathlib import Path

# By number of nodes: Gmsh's type, the sides S1, S2, ... by their corners.
PLANE = {3: (2, ("12", "23", "31")), 4: (3, ("12", "23", "34", "41")), 6: (9, ("12", "23", "31"))}
SOLID = {
    4: (4, ("123", "142", "243", "341")),
    6: (6, ("123", "465", "1452", "2563", "3641")),
    8: (5, ("1234", "5876", "1562", "2673", "3784", "4851")),
    10: (11, ("123", "142", "243", "341")),
}
MIDDLES = {6: {"12": 4, "23": 5, "13": 6}, 10: {"12": 5, "23": 6, "13": 7, "14": 8, "24": 9, "34": 10}}
SIDE_TYPES = {(2, 2): 1, (2, 3): 8, (3, 3): 2, (3, 4): 3, (3, 6): 9}


def blocks(path):
    """Yields (keyword, options, data lines) of each keyword of the file and of the files that it includes."""
    keyword, options, data, continued = "", {}, [], False
    for line in path.read_text(errors="replace").splitlines():
        if line.startswith("**") or not line.strip():
            continue
        if line.startswith("*") or continued:
            parts = [part.strip() for part in line.split(",")]
            if not continued:
                if keyword:
                    yield keyword, options, data
                keyword, options, data = " ".join(parts.pop(0)[1:].upper().split()), {}, []
            options.update((part.split("=", 1) + [""])[:2] for part in parts if part)
            options = {key.strip().upper(): value.strip() for key, value in options.items()}
            continued = line.rstrip().endswith(",")
            if keyword == "INCLUDE" and not continued:
                yield from blocks(path.parent / options["INPUT"])
                keyword = ""
        else:
            data.append([field.strip() for field in line.split(",") if field.strip()])
    if keyword:
        yield keyword, options, data


def read(path):
    nodes, elements, element_sets, node_sets, surfaces, materials = {}, {}, {}, {}, {}, []

    def members(options, data, sets):
        if "GENERATE" in options:
            return [n for row in data for n in range(int(row[0]), int(row[1]) + 1, int(row[2]) if len(row) > 2 else 1)]
        named = lambda field: [int(field)] if field.lstrip("-").isdigit() else sets[field.upper()]
        return [n for row in data for field in row for n in named(field)]

    for keyword, options, data in blocks(path):
        if keyword in ("PART", "INSTANCE", "ASSEMBLY", "NGEN", "NFILL", "ELGEN"):
            sys.exit(f"*{keyword}: expected a file without it (Abaqus/CAE: Edit Model Attributes, no parts and assemblies in input files)")
        if keyword == "NODE":
            new = {int(row[0]): [*map(float, row[1:4]), 0.0, 0.0][:3] for row in data}
            nodes.update(new)
            node_sets.setdefault(options.get("NSET", "").upper(), []).extend(new)
        elif keyword == "ELEMENT":
            kind = options["TYPE"].upper()
            family = PLANE if kind.startswith(("CPE", "CPS", "CAX")) else SOLID if kind.startswith("C3D") else {}
            count = int("".join(c if c.isdigit() else " " for c in kind.removeprefix("C3D")).split()[0]) if family else 0
            if count not in family:
                sys.exit(f"*ELEMENT, TYPE={kind}: expected CPE, CPS or CAX with 3, 4 or 6 nodes, or C3D4, 6, 8 or 10")
            flat = [int(field) for row in data for field in row]
            new = {flat[k]: flat[k + 1 : k + 1 + count] for k in range(0, len(flat), count + 1)}
            elements.update({number: (family, ids) for number, ids in new.items()})
            element_sets.setdefault(options.get("ELSET", "").upper(), []).extend(new)
        elif keyword == "NSET":
            node_sets.setdefault(options["NSET"].upper(), []).extend(members(options, data, node_sets))
        elif keyword == "ELSET":
            element_sets.setdefault(options["ELSET"].upper(), []).extend(members(options, data, element_sets))
        elif keyword == "SURFACE" and options.get("TYPE", "ELEMENT").upper() == "ELEMENT":
            for which, side in ((row[0], row[1]) for row in data):
                numbers = [int(which)] if which.isdigit() else element_sets[which.upper()]
                surfaces.setdefault(options["NAME"].upper(), []).extend((number, int(side[1:])) for number in numbers)
        elif keyword == "SOLID SECTION":
            materials.append(options["ELSET"].upper())
    return nodes, elements, element_sets, node_sets, surfaces, materials


def side_nodes(ids, corners):
    middle = MIDDLES.get(len(ids), {}) if len(corners) == 2 or len(ids) == 10 else {}
    pairs = ["".join(sorted(pair)) for pair in zip(corners, corners[1:] + corners[:1])]
    pairs = pairs[:1] if len(corners) == 2 else pairs
    return tuple([ids[int(c) - 1] for c in corners] + [ids[middle[pair] - 1] for pair in pairs if middle])


def main(source, target):
    nodes, elements, element_sets, node_sets, surfaces, materials = read(Path(source))
    dimension = 3 if any(family is SOLID for family, _ in elements.values()) else 2
    groups = {}
    for name in materials or filter(None, element_sets):
        for number in element_sets[name]:
            groups.setdefault(number, set()).add(name)
    facets, seen = {}, {}
    skin = {number: ids for number, (family, ids) in elements.items() if dimension == 3 and family is PLANE}
    for number in skin:
        del elements[number]
    for family, ids in elements.values():
        for corners in family[len(ids)][1]:
            facet = side_nodes(ids, corners)
            seen.setdefault(tuple(sorted(facet)), []).append(facet)
    for name, sides in surfaces.items():
        for number, side in sides:
            family, ids = elements[number]
            facet = side_nodes(ids, family[len(ids)][1][side - 1])
            facets.setdefault(seen[tuple(sorted(facet))][0], set()).add(name)
    for number, ids in skin.items():
        facet = seen.get(tuple(sorted(ids)), [None])[0]
        if facet and number in groups:
            facets.setdefault(facet, set()).update(groups[number])
    outer = [of[0] for of in seen.values() if len(of) == 1]
    points = []
    for name, members in node_sets.items():
        chosen = set(members)
        found = [facet for facet in outer if chosen.issuperset(facet)] if name else []
        for facet in found:
            facets.setdefault(facet, set()).add(name)
        points += [(name, n) for n in members] if name and not found and len(members) < 10 else []
    entities = {}  # (dimension, names) -> [(type, nodes)]
    for number, (family, ids) in elements.items():
        ids = ids[:8] + [ids[9], ids[8]] if len(ids) == 10 else ids
        entities.setdefault((dimension, tuple(sorted(groups.get(number, ())))), []).append((family[len(ids)][0], ids))
    for facet, names in facets.items():
        entities.setdefault((dimension - 1, tuple(sorted(names))), []).append((SIDE_TYPES[dimension, len(facet)], facet))
    names = sorted({(dim, name) for dim, all_ in entities for name in all_})
    tag = {name: k for k, name in enumerate(names, 1)}
    out = ["$MeshFormat", "4.1 0 8", "$EndMeshFormat", "$PhysicalNames", str(len(names))]
    out += [f'{dim} {tag[dim, name]} "{name}"' for dim, name in names] + ["$EndPhysicalNames", "$Entities"]
    out.append(" ".join(str(sum(dim == d for dim, _ in entities)) for d in range(4)))
    number = {key: k for k, key in enumerate(sorted(entities), 1)}
    for dim, all_ in sorted(entities):
        box = " ".join(f"{f(xyz[k] for xyz in nodes.values())!r}" for f in (min, max) for k in range(3))
        out.append(f"{number[dim, all_]} {box} {len(all_)} {' '.join(str(tag[dim, name]) for name in all_)} 0")
    out += ["$EndEntities", "$Nodes", f"1 {len(nodes)} {min(nodes)} {max(nodes)}", f"{dimension} {number[max(entities)]} 0 {len(nodes)}"]
    out += [str(n) for n in nodes] + [" ".join(map(repr, xyz)) for xyz in nodes.values()] + ["$EndNodes", "$Elements"]
    sorted_by_type = {}
    for key in sorted(entities):
        for kind, ids in entities[key]:
            sorted_by_type.setdefault((key, kind), []).append(ids)
    total = sum(map(len, sorted_by_type.values()))
    out.append(f"{len(sorted_by_type)} {total} 1 {total}")
    count = 0
    for (key, kind), all_ in sorted_by_type.items():
        out.append(f"{key[0]} {number[key]} {kind} {len(all_)}")
        for ids in all_:
            count += 1
            out.append(f"{count} " + " ".join(map(str, ids)))
    Path(target).write_text("\n".join(out + ["$EndElements", ""]))
    for dim, name in names:
        print("group   " if dim == dimension else "boundary", name)
    for name, n in points:
        print("point   ", name, nodes[n][:dimension])


if __name__ == "__main__":
    main(*sys.argv[1:3])
