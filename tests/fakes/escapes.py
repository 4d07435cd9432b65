"""Escapes that a confined process tries, by name: expressions, each of which does one if it is let.

They stand for native code that a file has led astray: whatever it could call. An expression that ends without
an error is an escape. `libc`, `call` and what the expressions name are in `PRELUDE`.
"""

from __future__ import annotations

PRELUDE = """
import ctypes, fcntl, mmap, os, platform, resource, signal, socket, sys, termios, threading
libc = ctypes.CDLL(None, use_errno=True)
parent = os.getppid()
arm = platform.machine() == "aarch64"
def checked(outcome):
    if outcome < 0:
        raise OSError(ctypes.get_errno(), os.strerror(ctypes.get_errno()))
    return outcome
def call(name, *arguments):
    return checked(getattr(libc, name)(*arguments))
def number(by_x86, by_arm, *arguments):
    return checked(libc.syscall(by_arm if arm else by_x86, *arguments))
def mapped(flags, size=1 << 20, rights=3):
    libc.mmap.restype = ctypes.c_void_p
    libc.mmap.argtypes = [ctypes.c_void_p, ctypes.c_size_t, *[ctypes.c_int] * 3, ctypes.c_long]
    place = libc.mmap(None, size, rights, flags, -1, 0)
    return checked(-1 if place == ctypes.c_void_p(-1).value else 0)
def by_another_table():
    # i386, whose call 39 is mkdir: mov eax, 20; int 0x80; ret
    code = mmap.mmap(-1, 4096, mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS, 7)
    code.write(bytes.fromhex("b814000000cd80c3"))
    place = ctypes.addressof(ctypes.c_char.from_buffer(code))
    outcome = ctypes.CFUNCTYPE(ctypes.c_int)(place)()
    if outcome < 0:
        raise OSError(-outcome, os.strerror(-outcome))
def thread():
    try:
        threading.Thread(target=int).start()
    except RuntimeError as error:
        raise PermissionError(str(error))
"""

FILES = {
    "a file": "open({canary!r}).read()",
    "a link in its folder": "open('link').read()",
    "a way up": "open('../canary').read()",
    "its environment": "open('/proc/self/environ').read()",
    "another's environment": "open(f'/proc/{{parent}}/environ').read()",
    "another's memory": "open(f'/proc/{{parent}}/mem', 'rb').read(1)",
    "a list of files": "os.listdir({outside!r})",
    "a file elsewhere": "open({outside!r} + '/made', 'w')",
    "a file cut elsewhere": "os.truncate({canary!r}, 0)",
    "a file removed elsewhere": "os.unlink({canary!r})",
    "a folder": "os.mkdir('folder')",
    "a link": "os.symlink({canary!r}, 'way')",
    "a hard link": "os.link({canary!r}, 'way')",
    "a pipe with a name": "os.mkfifo('pipe')",
    "a device": "os.mknod('device', 0o20666, os.makedev(1, 1))",
    "rights of a file": "os.chmod('link', 0o777)",
    "rights of an open file": "os.fchmod(0, 0o777)",
    "owner of a file": "os.chown('own', 0, 0)",
    "times of a file elsewhere": "os.utime({canary!r}, (0, 0))",
    "attribute of a file": "os.setxattr('own', 'user.a', b'1')",
    "another root": "os.chroot('.')",
    "a mount": "call('mount', b'none', b'.', b'tmpfs', 0, None)",
    "a place on disk at once": "os.posix_fallocate(os.open('own', os.O_RDWR), 0, 1 << 30)",
}
PROCESSES = {
    "a program": "os.execv('/bin/sh', ['sh', '-c', 'cat ' + {canary!r}])",
    "a fork": "os.fork() or os._exit(0)",
    "a thread": "thread()",
    "clone": "number(56, 220, 17, None, None, None, None) or os._exit(0)",
    "clone3": "number(435, 435, ctypes.create_string_buffer(88), 88) or os._exit(0)",
    "another session": "os.setsid()",
    "another group": "os.setpgid(0, 0)",
    "a signal": "os.kill(parent, 0)",
    "a signal to all": "os.kill(-1, 0)",
    "a signal to another's thread": "number(234, 131, parent, parent, 0)",
    "a signal in a queue": "number(129, 138, parent, 0, ctypes.create_string_buffer(128))",
    "a signal through a file": "fcntl.fcntl(0, fcntl.F_SETOWN, parent)",
    "a handle of a process": "os.pidfd_open(parent)",
    "limits of another": "resource.prlimit(parent, resource.RLIMIT_NOFILE)",
    "new limits of another": "resource.prlimit(parent, resource.RLIMIT_CORE, (0, 0))",
    "a new limit of itself": "resource.prlimit(0, resource.RLIMIT_CORE, (0, 0))",
    "its alarm": "number(38, 103, 0, ctypes.create_string_buffer(32), None)",
    "its end with its parent": "call('prctl', 1, 0, 0, 0, 0)",
    "priority of another": "os.setpriority(os.PRIO_PROCESS, parent, 0)",
    "processors of another": "os.sched_setaffinity(parent, os.sched_getaffinity(0))",
    "a trace": "call('ptrace', 16, parent, 0, 0)",
    "memory of another": "call('process_vm_readv', parent, None, 0, None, 0, 0)",
    "a namespace": "call('unshare', 0x10000000)",
}
SYSTEM = {
    "a connection": "socket.create_connection(('127.0.0.1', 9), timeout=1.0)",
    "a datagram": "socket.socket(socket.AF_INET, socket.SOCK_DGRAM)",
    "a socket of the system": "socket.socket(socket.AF_UNIX)",
    "a pair of sockets": "socket.socketpair()",
    "memory shared by a key": "call('shmget', 0, 1 << 20, 0o1600)",
    "memory shared by a file": "os.memfd_create('memory')",
    "memory shared by a map": "mapped(mmap.MAP_SHARED | mmap.MAP_ANONYMOUS)",
    "memory that grows by itself": "mapped(mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS | 0x100)",
    "messages": "call('msgget', 0, 0o1600)",
    "semaphores": "call('semget', 0, 1, 0o1600)",
    "io_uring": "number(425, 425, 1, ctypes.create_string_buffer(120))",
    "a key": "number(250, 219, 0, -3, 1)",
    "a program of the kernel": "number(321, 280, 0, ctypes.create_string_buffer(120), 120)",
    "counters of the machine": "number(298, 241, ctypes.create_string_buffer(120), 0, -1, -1, 0)",
    "faults in hand": "number(323, 282, 0)",
    "events": "number(290, 19, 0, 0)",
    "news of files": "number(294, 26, 0)",
    "keys typed for another": "fcntl.ioctl(0, termios.TIOCSTI, b'x')",
    "another personality": "number(135, 92, 0x0040000)",
    "another filter": "number(317, 277, 1, 0, None)",
    "calls of the second table": "checked(libc.syscall(0x40000000 | 39))",
}
BY_32_BITS = "by_another_table()"
"""On x86-64 alone; a system without that table ends the process."""
