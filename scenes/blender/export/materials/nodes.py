# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the value of a socket comes from: through reroutes, node groups and muted nodes."""

from typing import NamedTuple


class Input(NamedTuple):
    """An input socket, and the group nodes that it is inside of, from the outermost on."""
    socket: object
    groups: tuple = ()

    @property
    def node(self):
        return self.socket.node


class Source(NamedTuple):
    """What feeds an input: the output of a node, or an unlinked input with a value of its own.

    kinds: types of the sockets that the value passes, from the last to the first; each converts it.
    """
    socket: object
    groups: tuple
    kinds: tuple

    @property
    def node(self):
        return self.socket.node

    @property
    def is_constant(self):
        return not self.socket.is_output

    def input(self, name):
        """An input of the node by identifier or, where that is unknown, by name."""
        return Input(input_socket(self.node, name), self.groups)


def input_socket(node, *names):
    """The first input that has one of the names as its identifier or its name, or None."""
    for name in names:
        for socket in node.inputs:
            if socket.identifier == name:
                return socket
        for socket in node.inputs:
            if socket.name == name and socket.enabled:
                return socket
    return None


def active_output(tree, kind="NodeGroupOutput"):
    """The output node of a group, or None."""
    nodes = [node for node in tree.nodes if node.bl_idname == kind]
    return next((node for node in nodes if node.is_active_output), nodes[0] if nodes else None)


def _link(socket):
    """The link that feeds an input, or None."""
    if not socket.is_linked:
        return None
    return next((link for link in socket.links if link.is_valid and not link.is_muted), None)


def source_of(at):
    """The Source of an Input. None where nothing feeds a muted node, and in loops."""
    socket, groups = at
    kinds = [socket.type]
    met = set()
    while True:
        key = (socket.as_pointer(), tuple(group.as_pointer() for group in groups))
        if key in met:
            return None
        met.add(key)
        link = _link(socket)
        if link is None:
            return Source(socket, groups, tuple(kinds))
        output, node = link.from_socket, link.from_node
        if node.bl_idname == "NodeReroute":
            socket = node.inputs[0]
        elif node.mute:
            kinds.append(output.type)
            inside = next((each for each in node.internal_links if each.to_socket == output), None)
            if inside is None:
                return None
            socket = inside.from_socket
        elif node.bl_idname == "ShaderNodeGroup":
            end = active_output(node.node_tree) if node.node_tree is not None else None
            inner = input_socket(end, output.identifier) if end is not None else None
            if inner is None:
                return None
            kinds.append(output.type)
            socket, groups = inner, (*groups, node)
        elif node.bl_idname == "NodeGroupInput":
            outer = input_socket(groups[-1], output.identifier) if groups else None
            if outer is None:
                return None
            kinds.append(output.type)
            socket, groups = outer, groups[:-1]
        else:
            return Source(output, groups, tuple(kinds))
        kinds.append(socket.type)
