"""The frame loop of finger.c from Python through nothing but the C interface: no package, no numpy.

    python3 finger_ctypes.py libisochor_c.so scenes/meshes/finger_small.msh
"""
import ctypes as c
import sys


class Id(c.Structure):
    _fields_ = [("number", c.c_int32), ("generation", c.c_uint32), ("world", c.c_uint64)]


class Options(c.Structure):
    _fields_ = [
        ("size", c.c_size_t), ("scheme", c.c_int32), ("threads", c.c_int32), ("gravity", c.c_double * 3),
        ("folder", c.c_char_p), ("keys", c.c_char_p), ("log", c.c_void_p), ("log_user", c.c_void_p),
    ]


def main(library, mesh_file):
    iso = c.CDLL(library)
    iso.iso_last_error.restype = c.c_char_p
    world, mesh, message = c.c_void_p(), c.c_void_p(), c.create_string_buffer(500)

    def check(status):
        if status != 0:
            sys.exit((iso.iso_last_error(world) if world else message.value).decode())

    def names(*texts):
        return (c.c_char_p * len(texts))(*texts)

    check(iso.iso_mesh_read(mesh_file.encode(), c.c_double(1), c.byref(mesh), message, c.c_size_t(500)))
    options = Options(size=c.sizeof(Options), threads=1, gravity=(0, -9.81, 0))
    check(iso.iso_world_create(c.byref(options), c.byref(world), message, c.c_size_t(500)))
    finger, rows, clamp, air, floor = Id(), Id(), Id(), Id(), Id()
    check(iso.iso_add_soft_body(world, b"finger", mesh, c.c_double(100e3), c.c_double(0.5), c.c_double(1070),
                                c.byref(finger)))
    iso.iso_mesh_free(mesh)
    check(iso.iso_add_volume(world, finger, c.byref(rows)))
    check(iso.iso_add_support(world, b"clamp", finger, names(b"clamped"), c.c_size_t(1), c.byref(clamp)))
    check(iso.iso_add_cavity(world, b"air", finger, names(b"chamber"), c.c_size_t(1), c.byref(air)))
    check(iso.iso_add_floor(world, b"floor", finger, None, c.c_size_t(0), (c.c_double * 3)(0, -0.008, 0),
                            (c.c_double * 3)(0, 1, 0), c.c_double(0.3), c.byref(floor)))
    for frame in range(1, 31):
        check(iso.iso_set_amount(world, air, c.c_double(300.0 * frame)))
        check(iso.iso_advance(world, c.c_double(1.0 / 60), None))
    state = c.c_uint64()
    check(iso.iso_state_hash(world, c.byref(state)))
    print(f"{state.value:016x}")
    check(iso.iso_world_free(world))


main(*sys.argv[1:3])
