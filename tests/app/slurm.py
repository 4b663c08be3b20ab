"""Starts a Slurm cluster of one node on this machine, with munge, in a temporary folder."""
import os
import shutil
import socket
import subprocess
import time

PROGRAMS = ('munged', 'slurmctld', 'slurmd', 'sbatch', 'squeue', 'scontrol')
# Debian installs the daemons in folders that are only in root's PATH.
PATH = os.environ['PATH'] + ':/usr/sbin:/sbin'


def why_not():
    """Returns why no cluster can be started here; None if it can."""
    for name in PROGRAMS:
        if not shutil.which(name, path=PATH):
            return f'{name} is not installed (Debian: slurm-wlm, munge)'
    return None if os.getuid() == 0 else 'slurmd runs jobs as root alone'


def free_port():
    with socket.socket() as one:
        one.bind(('127.0.0.1', 0))
        return one.getsockname()[1]


CONFIGURATION = '''
ClusterName=lampyris
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={ctld_port}
SlurmdPort={slurmd_port}
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket={folder}/munge/socket,cred_expire=5
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SchedulerType=sched/backfill
SchedulerParameters=sched_interval=1,bf_interval=1,sched_min_interval=100000,requeue_delay=1
SlurmdParameters=config_overrides
MinJobAge=300
KillWait=10
ReturnToService=2
PreemptType=preempt/partition_prio
PreemptMode=REQUEUE
NodeName={host} NodeAddr=127.0.0.1 CPUs=2 RealMemory=1000 State=UNKNOWN
PartitionName=low Nodes={host} Default=YES MaxTime=INFINITE PriorityTier=1 State=UP
PartitionName=high Nodes={host} MaxTime=INFINITE PriorityTier=10 PreemptMode=OFF State=UP
'''


class Cluster:
    def __init__(self, folder):
        self.folder, self.daemons = folder, []
        self.env = {**os.environ, 'PATH': PATH, 'SLURM_CONF': os.path.join(folder, 'slurm.conf')}
        # munged requires folders to which nobody else can write.
        for name in ('munge', 'state', 'spool'):
            os.mkdir(os.path.join(folder, name), 0o755)
        host = socket.gethostname().split('.')[0]
        with open(self.env['SLURM_CONF'], 'w', encoding='ascii') as file:
            file.write(CONFIGURATION.format(host=host, folder=folder, ctld_port=free_port(),
                                            slurmd_port=free_port()))

    def start(self):
        munge = os.path.join(self.folder, 'munge')
        key = os.path.join(munge, 'key')
        with open(key, 'wb') as file:
            file.write(os.urandom(128))
        os.chmod(key, 0o600)
        self.daemon('munged', '--foreground', '--force', '--key-file', key, '--socket', munge + '/socket',
                    '--pid-file', munge + '/pid', '--log-file', munge + '/log', '--seed-file', munge + '/seed')
        self.wait(lambda: os.path.exists(munge + '/socket'), 'munged')
        self.daemon('slurmctld', '-D')
        self.daemon('slurmd', '-D')
        self.wait(lambda: 'idle' in self.output('sinfo', '--noheader', '--format=%t'), 'an idle node')

    def daemon(self, *command):
        with open(os.path.join(self.folder, command[0] + '.out'), 'wb') as out:
            self.daemons.append(subprocess.Popen(command, env=self.env, cwd=self.folder, stdout=out, stderr=out))

    def stop(self):
        for daemon in reversed(self.daemons):
            daemon.terminate()
        for daemon in reversed(self.daemons):
            try:
                daemon.wait(timeout=20)
            except subprocess.TimeoutExpired:
                daemon.kill()
                daemon.wait()

    def output(self, *command):
        return subprocess.run(command, env=self.env, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                              text=True, check=False).stdout

    def logs(self):
        text = ''
        for name in ('slurmctld.log', 'slurmd.log', 'munged.out', 'munge/log'):
            path = os.path.join(self.folder, name)
            if os.path.exists(path):
                with open(path, encoding='utf-8', errors='replace') as file:
                    text += f'--- {name}\n' + ''.join(file.readlines()[-30:])
        return text

    def wait(self, is_so, what, seconds=120):
        end = time.monotonic() + seconds
        while not is_so():
            if time.monotonic() > end:
                raise AssertionError(f'no {what} after {seconds} s\n' + self.logs())
            time.sleep(0.2)

    def states(self, job):
        """Returns the states of the job's tasks that Slurm knows, including tasks that have ended."""
        return self.output('squeue', '--noheader', '--array', '--states=all', '--format=%T', '--job', job).split()

    def wait_for_end(self, job, seconds=900):
        def has_ended():
            states = self.states(job)
            return states and not any(s in ('PENDING', 'RUNNING', 'COMPLETING', 'CONFIGURING', 'REQUEUED')
                                      for s in states)
        self.wait(has_ended, f'end of job {job}', seconds)
        return self.states(job)
