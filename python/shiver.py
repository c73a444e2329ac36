"""Shiver from Python: live simulations and run files as NumPy arrays, by ctypes and the shared library alone.

    import shiver

    simulation = shiver.Simulation(shiver.Scene("drop.yaml", {"duration": 1}))
    simulation.on_event = lambda event: print(event["time"], event["kind"], event["fragment"])
    simulation.step(0.01)
    simulation.enter("ball", position=(0, 0, 0.1), velocity=(0, 0, -5))
    simulation.step(0.02)
    print(simulation.fragments["position"])

    run = shiver.RunFile("drop.h5")
    print(run.times, run.frame(-1)["position"])

Quantities are in SI units; orientations are quaternions (w, x, y, z). Every failure of the library is a shiver.Error with its message.
"""
import ctypes
import ctypes.util
import glob
import os
from ctypes import POINTER, byref, c_bool, c_char, c_char_p, c_double, c_int, c_int32, c_int64, c_size_t, c_uint32, c_uint64, c_uint8, c_void_p

import numpy as np

__all__ = ["Error", "Scene", "Simulation", "RunFile", "run", "version"]

_COOKIE = 0x53484956  # SHV_DEFINITION_COOKIE


# ---- the library ----


def _find_library():
    """The one that SHIVER_LIBRARY names, the one beside this file's own prefix, the system's."""
    named = os.environ.get("SHIVER_LIBRARY")
    if named:
        return named
    here = os.path.dirname(os.path.abspath(__file__))
    for folder in ("..", "../..", "../../..", "../../*", "../../lib", "../../lib/*", "../../../lib", "../../../lib/*"):
        for found in sorted(glob.glob(os.path.join(here, folder, "libshiver.so.0*"))):
            return found
    return ctypes.util.find_library("shiver") or "libshiver.so.0.1"


_library = ctypes.CDLL(_find_library())


class _ErrorStruct(ctypes.Structure):
    _fields_ = [("status", c_int), ("message", c_char * 1024)]


class Error(Exception):
    """What the library says went wrong; `status` is its short name ("bad input", "diverged", …)."""

    def __init__(self, message, status):
        super().__init__(message)
        self.status = status


def _function(name, result, *arguments):
    function = getattr(_library, name)
    function.restype = result
    function.argtypes = arguments
    return function


_status_name = _function("shv_status_name", c_char_p, c_int)


def _call(name, *arguments):
    """A function whose last argument is an error: raises it."""
    error = _ErrorStruct()
    status = getattr(_library, name)(*arguments, byref(error))
    if status != 0:
        raise Error(error.message.decode(errors="replace"), _status_name(status).decode())


def version():
    return _function("shv_version", c_char_p)().decode()


# ---- structs, as in the public headers; their sizes are compared with the library's ----


class _Placement(ctypes.Structure):
    _fields_ = [("position", c_double * 3), ("rotation_axis", c_double * 3), ("rotation_degrees", c_double),
                ("velocity", c_double * 3), ("angular_velocity", c_double * 3), ("stretch_rate", c_double * 3)]


class _EventDefinition(ctypes.Structure):
    _fields_ = [("cookie", c_uint32), ("time", c_double), ("kind", c_int), ("target", c_char_p), ("value", c_double * 3),
                ("angular", c_double * 3)]


class _EventView(ctypes.Structure):
    _fields_ = [("time", c_double), ("kind", c_int), ("fragment", c_int32), ("obstacle", c_int32), ("value", c_double),
                ("kinetic_before", c_double), ("kinetic_after", c_double), ("strain_before", c_double),
                ("strain_after", c_double), ("momentum_before", c_double * 3), ("momentum_after", c_double * 3),
                ("angular_before", c_double * 3), ("angular_after", c_double * 3), ("reason", c_int), ("hulls", c_int32),
                ("mass", c_double), ("momentum_scale", c_double), ("angular_scale", c_double),
                ("cohesive_before", c_double), ("cohesive_after", c_double), ("dropped_vibration", c_double),
                ("dropped_strain", c_double), ("dropped_cohesive", c_double), ("hull_outside", c_double),
                ("hull_missing", c_double)]


class _LedgerView(ctypes.Structure):
    _fields_ = [(name, c_double) for name in (
        "time kinetic strain gravity_potential cohesive_recoverable fracture_dissipation contact friction closure crack_friction "
        "constraint traction bars damping handover event step_change cohesive cohesive_released cohesive_defect failed_area inserted_area "
        "fracture_energy_area").split()] + [("momentum", c_double * 3), ("angular_momentum", c_double * 3),
                                            ("residual", c_double), ("largest", c_double)]


class _ObstacleView(ctypes.Structure):
    _fields_ = [("name", c_char_p), ("position", c_double * 3), ("orientation", c_double * 4), ("velocity", c_double * 3),
                ("angular_velocity", c_double * 3)]


class _FrameView(ctypes.Structure):
    _fields_ = [("time", c_double), ("animation", c_bool), ("fracture", c_bool), ("fragments", c_void_p),
                ("fragment_count", c_int32), ("alive_count", c_int32), ("obstacles", POINTER(_ObstacleView)),
                ("obstacle_count", c_int32), ("events", POINTER(_EventView)), ("event_count", c_int32),
                ("probes", c_void_p), ("probe_count", c_int32), ("probe_times", c_void_p), ("probe_samples", c_void_p),
                ("probe_row_count", c_int64), ("ledger", _LedgerView), ("steps", c_int64), ("step", c_double),
                ("courant", c_double), ("inserted", c_int32), ("failed", c_int32), ("pieces", c_int32 * 3),
                ("softened", c_int32), ("audited", c_int32), ("missed", c_int32), ("worst_overshoot", c_double),
                ("cohesive_share", c_double), ("contact_impulse", c_double * 3), ("contact_time", c_double),
                ("first_contact", c_double), ("last_contact", c_double), ("edge_strain", c_double),
                ("bar_work_share", c_double), ("costs", c_void_p), ("cost_count", c_int32), ("bytes", c_void_p),
                ("bytes_count", c_int32)]


class _MeshView(ctypes.Structure):
    _fields_ = [("node_count", c_int32), ("element_count", c_int32), ("positions", POINTER(c_double)),
                ("elements", POINTER(c_int32)), ("objects", c_void_p), ("object_count", c_int32)]


class _ObjectView(ctypes.Structure):
    _fields_ = [("name", c_char_p), ("material", c_char_p), ("element_begin", c_int32), ("element_end", c_int32),
                ("node_begin", c_int32), ("node_end", c_int32)]


class _SimulationOptions(ctypes.Structure):
    _fields_ = [("cookie", c_uint32), ("folder", c_char_p), ("memory", c_void_p), ("audit_wakes", c_int32),
                ("stop", c_void_p), ("stop_data", c_void_p)]


class _RecordDefinition(ctypes.Structure):
    _fields_ = [("cookie", c_uint32), ("path", c_char_p), ("force", c_bool), ("scene_name", c_char_p),
                ("scene_text", c_char_p), ("overrides", POINTER(c_char_p)), ("override_count", c_int32),
                ("scene_hash", c_uint64), ("resume_hash", c_uint64), ("threads", c_int32), ("nodes", c_bool),
                ("sync_interval", c_double), ("memory", c_void_p)]


class _RunFileInfo(ctypes.Structure):
    _fields_ = [("format", c_int32), ("code_version", c_char_p), ("status", c_char_p), ("message", c_char_p),
                ("scene_text", c_char_p), ("scene_name", c_char_p), ("processor", c_char_p), ("rigid_engine", c_char_p),
                ("overrides", c_char_p), ("nodes", c_bool), ("live", c_bool), ("scene_hash", c_uint64),
                ("threads", c_int32), ("node_count", c_int32),
                ("element_count", c_int32), ("object_count", c_int32), ("obstacle_count", c_int32),
                ("fragment_count", c_int32), ("probe_count", c_int32), ("frame_count", c_int64), ("event_count", c_int64),
                ("probe_row_count", c_int64), ("first_time", c_double), ("last_time", c_double),
                ("wall_seconds", c_double)]


_FRAGMENT = np.dtype([("id", "i4"), ("parent", "i4"), ("object", "i4"), ("birth", "f8"), ("death", "f8"), ("mode", "i4"),
                      ("tets", "i4"), ("mass", "f8"), ("volume", "f8"), ("inertia", "f8", 6),
                      ("reference_centre", "f8", 3), ("position", "f8", 3), ("orientation", "f8", 4),
                      ("velocity", "f8", 3), ("angular_velocity", "f8", 3)], align=True)

#: Values of the field `mode` of fragments.
FLIGHT, FRACTURE, DEAD, AWAY = 0, 1, 2, 3

_struct_size = _function("shv_struct_size", c_size_t, c_char_p)
_SIZES = {"ShvError": ctypes.sizeof(_ErrorStruct), "ShvFragmentView": _FRAGMENT.itemsize}
_SIZES.update({"Shv" + struct.__name__[1:]: ctypes.sizeof(struct) for struct in (
    _Placement, _EventDefinition, _EventView, _LedgerView, _ObstacleView, _FrameView, _MeshView, _ObjectView,
    _SimulationOptions, _RecordDefinition, _RunFileInfo)})
for _name, _size in _SIZES.items():
    if _struct_size(_name.encode()) != _size:
        raise ImportError(f"libshiver {version()} is not the one that this shiver.py belongs to: {_name} has "
                          f"{_struct_size(_name.encode())} bytes there and {_size} here; install both from one package")

_event_name = _function("shv_run_event_name", c_char_p, c_int)
_reason_name = _function("shv_switch_reason_name", c_char_p, c_int)
for _name in ("scene_load", "scene_parse", "scene_give_mesh", "simulation_create", "simulation_advance", "simulation_step",
              "simulation_apply", "simulation_push", "simulation_enter", "simulation_leave", "simulation_remove",
              "record_create", "record_frame", "record_close", "run_file_open", "run_file_frame", "run_file_fragments",
              "run_file_event", "run_file_ledger", "run_file_mesh", "run_file_corners"):
    getattr(_library, "shv_" + _name).restype = c_int
_definition = _function("shv_scene_definition", c_void_p, c_void_p)
_scene_destroy = _function("shv_scene_destroy", None, c_void_p)
_scene_folder = _function("shv_scene_folder", c_char_p, c_void_p)
_scene_text = _function("shv_scene_text", c_char_p, c_void_p)
_scene_hash = _function("shv_scene_hash", c_uint64, c_void_p)
_simulation_destroy = _function("shv_simulation_destroy", None, c_void_p)
_simulation_finished = _function("shv_simulation_finished", c_bool, c_void_p)
_simulation_frame = _function("shv_simulation_frame", POINTER(_FrameView), c_void_p)
_simulation_mesh = _function("shv_simulation_mesh", _MeshView, c_void_p)
_simulation_threads = _function("shv_simulation_threads", c_int32, c_void_p)
_corner_positions = _function("shv_simulation_corner_positions", None, c_void_p, c_void_p)
_LISTENER = ctypes.CFUNCTYPE(None, c_void_p, POINTER(_EventView))
_listen = _function("shv_simulation_listen", None, c_void_p, _LISTENER, c_void_p)
_run_file_close = _function("shv_run_file_close", None, c_void_p)
_run_file_info = _function("shv_run_file_info", POINTER(_RunFileInfo), c_void_p)
_run_file_times = _function("shv_run_file_times", POINTER(c_double), c_void_p)
_run_file_object_name = _function("shv_run_file_object_name", c_char_p, c_void_p, c_int32)


# ---- arrays ----


def _vector(value, what):
    array = np.asarray(value, dtype=float)
    if array.shape != (3,):
        raise ValueError(f"{what} must be three numbers, not an array of the shape {array.shape}")
    return (c_double * 3)(*array)


def _table(value, columns, kind, what):
    """A copy in C's order; numbers that would lose by it are refused."""
    array = np.asarray(value)
    if array.ndim != 2 or array.shape[1] != columns or array.size == 0:
        raise ValueError(f"{what} must be an array of the shape (n, {columns}), not {array.shape}")
    if not np.can_cast(array.dtype, kind, "same_kind"):
        raise TypeError(f"{what} must be {np.dtype(kind).name}, not {array.dtype.name}")
    made = np.ascontiguousarray(array, dtype=kind)
    if not np.array_equal(made, array):
        raise ValueError(f"{what} holds numbers that do not fit {np.dtype(kind).name}, or no numbers")
    return made


def _pointer(array):
    return array.ctypes.data_as(c_void_p)


def _plain(struct):
    """Its fields as a dictionary of numbers and arrays."""
    fields = {}
    for name, kind in struct._fields_:
        value = getattr(struct, name)
        fields[name] = np.array(value) if isinstance(value, ctypes.Array) else value
    return fields


def _event(view):
    fields = _plain(view)
    fields["kind"] = _event_name(view.kind).decode()
    fields["reason"] = _reason_name(view.reason).decode()
    return fields


# ---- scenes and simulations ----


class Scene:
    """A scene from a file, or from YAML with text=…; `settings` maps keys ("materials.glass.density") to values."""

    def __init__(self, path=None, settings=None, text=None):
        if (path is None) == (text is None):
            raise ValueError("give a path or text=…, one of the two")
        given = [f"{key}={_yaml(value)}".encode() for key, value in (settings or {}).items()]
        self._overrides = (c_char_p * len(given))(*given)
        self._handle = c_void_p()
        if text is None:
            _call("shv_scene_load", byref(self._handle), os.fsencode(path), self._overrides, c_int32(len(given)), None, None)
        else:
            data = text.encode()
            _call("shv_scene_parse", byref(self._handle), data, c_size_t(len(data)), b"scene", None, self._overrides,
                  c_int32(len(given)), None, None)

    def give_mesh(self, name, positions, tets):
        """Nodes (n × 3, m) and tets (n × 4, nodes from 0) of an object whose mesh is `memory: {scale: 1}`."""
        nodes, corners = _table(positions, 3, "f8", "positions"), _table(tets, 4, "i4", "tets")
        _call("shv_scene_give_mesh", self._handle, name.encode(), _pointer(nodes), c_int32(len(nodes)), _pointer(corners),
              c_int32(len(corners)))

    def __del__(self):
        if getattr(self, "_handle", None):
            _scene_destroy(self._handle)


def _yaml(value):
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (list, tuple, np.ndarray)):
        return "[" + ", ".join(_yaml(item) for item in value) + "]"
    return repr(float(value)) if isinstance(value, (float, np.floating)) else str(value)


class Simulation:
    """A scene that runs, driven step by step. `on_event`, if set, is called with a dictionary for every event of a step."""

    def __init__(self, scene):
        self._scene, self._handle, self._raised, self.on_event = scene, c_void_p(), None, None
        options = _SimulationOptions(cookie=_COOKIE, folder=_scene_folder(scene._handle))
        _call("shv_simulation_create", byref(self._handle), c_void_p(_definition(scene._handle)), byref(options))
        self._listener = _LISTENER(self._hear)
        _listen(self._handle, self._listener, None)
        self._change("shv_simulation_advance")

    def _hear(self, _, event):
        """An exception cannot pass through C: it is raised when the step is done."""
        if self.on_event is None or self._raised:
            return
        try:
            self.on_event(_event(event.contents))
        except BaseException as raised:  # pylint: disable=broad-except
            self._raised = raised

    def _change(self, function, *arguments):
        _call(function, self._handle, *arguments)
        raised, self._raised = self._raised, None
        if raised:
            raise raised

    def step(self, until):
        """Goes on to a time, s."""
        self._change("shv_simulation_step", c_double(until))

    def enter(self, name, position, velocity=(0, 0, 0), rotation=((0, 0, 1), 0), angular_velocity=(0, 0, 0)):
        """Brings an object or a free obstacle that waits; `rotation` is an axis and degrees."""
        placement = _Placement(position=_vector(position, "position"), velocity=_vector(velocity, "velocity"),
                               rotation_axis=_vector(rotation[0], "the axis of the rotation"),
                               rotation_degrees=rotation[1],
                               angular_velocity=_vector(angular_velocity, "angular_velocity"))
        self._change("shv_simulation_enter", name.encode(), byref(placement))

    def leave(self, name):
        """Takes out all of an object, or a free obstacle."""
        self._change("shv_simulation_leave", name.encode())

    def remove(self, fragment):
        """Takes out one fragment."""
        self._change("shv_simulation_remove", c_int32(fragment))

    def push(self, fragment, impulse, point=None):
        """An impulse, N s, at a world point of one fragment, or at its centre. A force F over a step of Δt is F Δt."""
        at = self.fragments["position"][fragment] if point is None else point
        self._change("shv_simulation_push", c_int32(fragment), _vector(impulse, "impulse"), _vector(at, "point"))

    def _apply(self, kind, target, value, angular=(0, 0, 0)):
        event = _EventDefinition(cookie=_COOKIE, kind=kind, target=target.encode() if target else None,
                                 value=_vector(value, "the value"), angular=_vector(angular, "angular_velocity"))
        self._change("shv_simulation_apply", byref(event))

    def release(self, condition):
        """A support or an imposed velocity holds no more."""
        self._apply(0, condition, (0, 0, 0))

    def set_velocity(self, name, velocity, angular_velocity=(0, 0, 0)):
        """Of all fragments of an object, or of a free obstacle."""
        self._apply(1, name, velocity, angular_velocity)

    def impulse(self, name, impulse):
        """On an object, shared by mass, or on a free obstacle, N s."""
        self._apply(2, name, impulse)

    def set_gravity(self, gravity):
        self._apply(3, None, gravity)

    @property
    def _frame(self):
        return _simulation_frame(self._handle).contents

    @property
    def time(self):
        return self._frame.time

    @property
    def finished(self):
        return _simulation_finished(self._handle)

    @property
    def ledger(self):
        return _plain(self._frame.ledger)

    @property
    def fragments(self):
        """All that ever lived, by id, as a structured array; `mode` is FLIGHT, FRACTURE, DEAD or AWAY."""
        frame = self._frame
        data = ctypes.string_at(frame.fragments, frame.fragment_count * _FRAGMENT.itemsize)
        return np.frombuffer(data, dtype=_FRAGMENT)

    @property
    def obstacles(self):
        """Pose and velocities of each, by name."""
        views = [self._frame.obstacles[i] for i in range(self._frame.obstacle_count)]
        return {view.name.decode(): {key: value for key, value in _plain(view).items() if key != "name"} for view in views}

    @property
    def mesh(self):
        """Nodes (n × 3) and tets (n × 4) of all objects at the start."""
        mesh = _simulation_mesh(self._handle)
        return (np.ctypeslib.as_array(mesh.positions, (mesh.node_count, 3)).copy(),
                np.ctypeslib.as_array(mesh.elements, (mesh.element_count, 4)).copy())

    @property
    def corners(self):
        """Where the corners of every tet are now (n × 4 × 3)."""
        corners = np.empty((_simulation_mesh(self._handle).element_count, 4, 3))
        _corner_positions(self._handle, _pointer(corners))
        return corners

    def __del__(self):
        if getattr(self, "_handle", None):
            _simulation_destroy(self._handle)


def run(scene, output, force=False, nodes=False):
    """Runs a Scene (or the file of one) to its end into a run file, and opens that."""
    scene = scene if isinstance(scene, Scene) else Scene(scene)
    simulation, record = Simulation(scene), c_void_p()
    definition = _RecordDefinition(cookie=_COOKIE, path=os.fsencode(output), force=force, nodes=nodes, sync_interval=5.0,
                                   scene_text=_scene_text(scene._handle), overrides=scene._overrides,
                                   override_count=len(scene._overrides), scene_hash=_scene_hash(scene._handle),
                                   threads=_simulation_threads(simulation._handle))
    _call("shv_record_create", byref(record), byref(definition), simulation._handle)
    status, message = 4, b"stopped by an exception"  # SHV_DIVERGED, unless all goes well
    try:
        _call("shv_record_frame", record, simulation._handle)
        while not simulation.finished:
            simulation._change("shv_simulation_advance")
            _call("shv_record_frame", record, simulation._handle)
        status, message = 0, None
    finally:
        _call("shv_record_close", record, c_int(status), message)
    return RunFile(output)


# ---- run files ----


class RunFile:
    """A run file as arrays."""

    def __init__(self, path):
        self._handle = c_void_p()
        _call("shv_run_file_open", byref(self._handle), os.fsencode(path), None)
        info = _run_file_info(self._handle).contents
        self.info = {name: value.decode() if isinstance(value, bytes) else value
                     for name, value in ((field, getattr(info, field)) for field, _ in _RunFileInfo._fields_)}
        count = info.frame_count
        self.times = np.ctypeslib.as_array(_run_file_times(self._handle), (count,)).copy() if count else np.empty(0)
        self.objects = [_run_file_object_name(self._handle, c_int32(i)).decode() for i in range(info.object_count)]

    def _index(self, frame):
        if not -len(self.times) <= frame < len(self.times):
            raise IndexError(f"there is no frame {frame}, only {len(self.times)}")
        return c_int64(frame % len(self.times))

    def frame(self, frame):
        """Time, and of all fragments: alive, position, orientation, velocity, angular_velocity (NaN where not alive)."""
        count, time, mode = self.info["fragment_count"], c_double(), c_int32()
        alive = np.empty(count, dtype="u1")
        made = {"position": np.empty((count, 3)), "orientation": np.empty((count, 4)), "velocity": np.empty((count, 3)),
                "angular_velocity": np.empty((count, 3))}
        _call("shv_run_file_frame", self._handle, self._index(frame), byref(time), byref(mode), _pointer(alive),
              *(_pointer(array) for array in made.values()))
        return {"time": time.value, "fracture": bool(mode.value), "alive": alive.astype(bool), **made}

    @property
    def fragments(self):
        """Genealogy and constants of all fragments, by id."""
        made = np.empty(self.info["fragment_count"], dtype=_FRAGMENT)
        _call("shv_run_file_fragments", self._handle, _pointer(made))
        return made

    @property
    def events(self):
        views = [_EventView() for _ in range(self.info["event_count"])]
        for i, view in enumerate(views):
            _call("shv_run_file_event", self._handle, c_int64(i), byref(view))
        return [_event(view) for view in views]

    def ledger(self, frame):
        view = _LedgerView()
        _call("shv_run_file_ledger", self._handle, self._index(frame), byref(view))
        return _plain(view)

    @property
    def mesh(self):
        """Nodes (n × 3) and tets (n × 4) at the start, and which object each tet is of."""
        nodes, tets = np.empty((self.info["node_count"], 3)), np.empty((self.info["element_count"], 4), dtype="i4")
        owners = np.empty(self.info["element_count"], dtype="u2")
        _call("shv_run_file_mesh", self._handle, _pointer(nodes), _pointer(tets), _pointer(owners), None)
        return nodes, tets, owners

    def corners(self, frame):
        """Corners of every tet (n × 4 × 3), damage of its facets (n × 4) and its fragment, of a run with `nodes: true`."""
        count = self.info["element_count"]
        corners, damage, owner = np.empty((count, 4, 3)), np.empty((count, 4)), np.empty(count, dtype="i4")
        _call("shv_run_file_corners", self._handle, self._index(frame), _pointer(corners), _pointer(damage), _pointer(owner))
        return corners, damage, owner

    def __del__(self):
        if getattr(self, "_handle", None):
            _run_file_close(self._handle)
