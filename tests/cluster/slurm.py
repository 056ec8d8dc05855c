"""Slurm on this machine alone: munged, slurmctld and two slurmd on loopback ports, with all their files in one directory.

    with Cluster(directory) as cluster:
        subprocess.run(["squeue"], env=cluster.env)

Debian's munge, slurmctld, slurmd and slurm-client (tools/setup); needs root, as slurmd starts processes for users.
"""

import os
import pathlib
import shutil
import socket
import subprocess
import time

# Where srun looks within jobs: the executor of Snakemake clears SLURM_CONF for it.
SYSTEM_CONF = pathlib.Path("/etc/slurm/slurm.conf")
PROGRAMS = ["munged", "slurmctld", "slurmd", "sbatch", "scontrol", "squeue"]
NODES = ["n1", "n2"]

CONF = """
ClusterName=loopback
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={controller}
AuthType=auth/munge
AuthInfo=socket={here}/munge.socket
CredType=cred/munge
SlurmUser=root
SlurmdUser=root
StateSaveLocation={here}/state
SlurmdSpoolDir={here}/spool/%n
SlurmctldPidFile={here}/slurmctld.pid
SlurmdPidFile={here}/%n.pid
SlurmctldLogFile={here}/slurmctld.log
SlurmdLogFile={here}/%n.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
CommunicationParameters=NoInAddrAny,NoCtldInAddrAny
SchedulerParameters=sched_interval=2,batch_sched_delay=1
SlurmctldTimeout=30
SlurmdTimeout=30
ReturnToService=2
JobRequeue=1
MinJobAge=300
KillWait=30
MpiDefault=none
{nodes}
PartitionName=main Nodes=ALL Default=YES MaxTime=INFINITE State=UP
"""


def missing_programs():
    """Names of programs that are not installed."""
    paths = os.pathsep.join([os.environ.get("PATH", ""), "/usr/sbin", "/sbin"])
    return [name for name in PROGRAMS if shutil.which(name, path=paths) is None]


def free_ports(number):
    sockets = [socket.socket() for _ in range(number)]
    for s in sockets:
        s.bind(("127.0.0.1", 0))
    ports = [s.getsockname()[1] for s in sockets]
    for s in sockets:
        s.close()
    return ports


class Cluster:
    """Two nodes of `cpus` processors each."""

    def __init__(self, directory, cpus=2):
        self.here = pathlib.Path(directory).resolve()
        self.env = {**os.environ, "SLURM_CONF": str(self.here / "slurm.conf"), "MUNGE_SOCKET": str(self.here / "munge.socket")}
        self.env["PATH"] = os.pathsep.join([self.env.get("PATH", ""), "/usr/sbin", "/sbin"])
        self.cpus = cpus
        self.daemons = {}
        self.linked = False

    def __enter__(self):
        lacking = missing_programs()
        if lacking:
            raise RuntimeError(f"Slurm cannot start: {', '.join(lacking)} not installed; tools/setup installs them")
        try:
            self._write()
            self._link()
            self._start_munge()
            self._start("slurmctld", ["slurmctld", "-D"])
            for node in NODES:
                self.start_node(node)
            self._wait(lambda: self.states() == {node: "idle" for node in NODES}, 60, "both nodes are idle")
        except BaseException:
            self.__exit__()
            raise
        return self

    def __exit__(self, *_):
        for name in [*NODES, "slurmctld", "munged"]:
            self._end(name)
        if self.linked:
            SYSTEM_CONF.unlink(missing_ok=True)

    def _link(self):
        """Makes its configuration that of this machine, which must have no other Slurm."""
        if SYSTEM_CONF.exists():
            raise RuntimeError(f"Slurm cannot start: {SYSTEM_CONF} is there: this machine has a Slurm of its own, or another test runs")
        SYSTEM_CONF.parent.mkdir(parents=True, exist_ok=True)
        SYSTEM_CONF.unlink(missing_ok=True)  # of a test that was killed
        SYSTEM_CONF.symlink_to(self.here / "slurm.conf")
        self.linked = True

    def _write(self):
        for name in ["state", "spool/n1", "spool/n2"]:
            (self.here / name).mkdir(parents=True, exist_ok=True)
        controller, *ports = free_ports(1 + len(NODES))
        host = socket.gethostname().split(".")[0]
        nodes = "\n".join(f"NodeName={node} NodeHostname={host} NodeAddr=127.0.0.1 Port={port} CPUs={self.cpus} RealMemory=4000 State=UNKNOWN"
                          for node, port in zip(NODES, ports))
        (self.here / "slurm.conf").write_text(CONF.format(here=self.here, host=host, controller=controller, nodes=nodes))
        key = self.here / "munge.key"
        key.write_bytes(os.urandom(1024))
        key.chmod(0o400)

    def _start_munge(self):
        self.here.chmod(0o755)  # munged looks at who may write where its socket is
        socket_file = self.here / "munge.socket"
        self._start("munged", ["munged", "--foreground", "--force", f"--socket={socket_file}", f"--key-file={self.here}/munge.key",
                               f"--pid-file={self.here}/munge.pid", f"--log-file={self.here}/munge.log",
                               f"--seed-file={self.here}/munge.seed"])
        self._wait(socket_file.exists, 20, "munged has made its socket")

    def _start(self, name, command):
        with open(self.here / f"{name}.out", "ab") as out:
            self.daemons[name] = subprocess.Popen(command, env=self.env, stdin=subprocess.DEVNULL, stdout=out, stderr=out,
                                                  start_new_session=True)

    def _end(self, name, kill=False):
        process = self.daemons.pop(name, None)
        if process is None:
            return
        if kill:
            process.kill()
        else:
            process.terminate()
        try:
            process.wait(timeout=20)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()

    def _wait(self, condition, seconds, what):
        end = time.monotonic() + seconds
        while not condition():
            dead = [name for name, process in self.daemons.items() if process.poll() is not None]
            if dead or time.monotonic() > end:
                said = {name: (self.here / f"{name}.out").read_text(errors="replace")[-500:] for name in dead or self.daemons}
                raise RuntimeError(f"Slurm cannot start: not so within {seconds} s: {what}; "
                                   f"{'ended: ' + ', '.join(dead) if dead else 'all daemons run'}; {said}")
            time.sleep(0.2)

    def run(self, *command, check=True):
        return subprocess.run(command, env=self.env, capture_output=True, text=True, timeout=60, check=check).stdout

    def states(self):
        """State of each node, idle, mixed, down .., without the marks for nodes that do not answer."""
        try:
            lines = self.run("sinfo", "--noheader", "-N", "--format=%N %t").split("\n")
        except subprocess.CalledProcessError:
            return {}
        return dict(line.split() for line in lines if line)

    def start_node(self, node):
        self._start(node, ["slurmd", "-D", "-N", node])

    def stop_node(self, node, kill=False):
        """Ends slurmd, not the processes of jobs that it has started."""
        self._end(node, kill)

    def set_node(self, node, state):
        self.run("scontrol", "update", f"NodeName={node}", f"State={state}", "Reason=test", check=False)

    def jobs(self):
        """Lines of squeue: number, state, node."""
        return [line.split("|") for line in self.run("squeue", "--noheader", "--format=%i|%T|%N", check=False).split("\n") if line]
