import os
from types import SimpleNamespace, TracebackType
from typing import Any, Callable, Dict, Iterator, List, NamedTuple, Optional, Sequence, Tuple, Type, Union

__version__: str
_Path = Union[str, "os.PathLike[str]"]
_Progress = Optional[Callable[["Moment"], Optional[bool]]]
_SceneLike = Union["Scene", _Path, Dict[str, Any]]

class Error(Exception):
    status: int
    path: Optional[str]
    pointer: Optional[str]
    expected: Optional[str]
    def __init__(self, message: str, path: Optional[str] = ..., pointer: Optional[str] = ...,
                 expected: Optional[str] = ...) -> None: ...

class InputError(Error, ValueError): ...
class DeviceError(Error, RuntimeError): ...
class NoVulkanError(DeviceError): ...
class OutputError(Error): ...
class Stopped(Error): ...

class Device(NamedTuple):
    index: int
    name: str
    driver: str
    kind: str
    memory_bytes: int
    is_cpu: bool
    unusable: Optional[str]

class Moment(NamedTuple):
    phase: str
    fraction: float
    samples: int
    seconds: float
    rays: int

class Part(NamedTuple):
    kind: str
    name: str
    reason: Optional[str]
    bytes: int
    is_left_out: bool

class Interval(NamedTuple):
    value: float
    low: float
    high: float

class Metrics(NamedTuple):
    mse: Interval
    relmse: Interval
    local_relmse: Interval
    smape: float
    psnr: float
    ssim: float
    flip: float
    hdr_flip: float
    max: float
    pixels_nonfinite: int
    pixels_differing: int

class Context:
    def __init__(self, device: Union[str, int, None] = ..., memory_bytes: int = ..., validation: bool = ...) -> None: ...
    def devices(self) -> List[Device]: ...
    def close(self) -> None: ...
    def __enter__(self) -> Context: ...
    def __exit__(self, kind: Optional[Type[BaseException]], value: Optional[BaseException],
                 trace: Optional[TracebackType]) -> None: ...

class Pixels:
    width: int
    height: int
    channels: int
    shape: Tuple[int, ...]
    address: int
    view: memoryview
    __array_interface__: Dict[str, Any]
    def tolist(self) -> List[Any]: ...
    def __len__(self) -> int: ...
    def __getitem__(self, place: Any) -> Any: ...

class Scene:
    def __init__(self, document: Optional[Dict[str, Any]] = ..., *, folder: Optional[_Path] = ...,
                 defines: Optional[Dict[str, Any]] = ..., allow_outside_paths: bool = ..., strict: bool = ...,
                 context: Optional[Context] = ...) -> None: ...
    document: Any
    def __getitem__(self, pointer: str) -> Any: ...
    def __setitem__(self, pointer: str, value: Any) -> None: ...
    def __delitem__(self, pointer: str) -> None: ...
    def __contains__(self, pointer: str) -> bool: ...
    def mesh(self, name: str, positions: Any, indices: Any = ..., *, normals: Any = ..., uvs: Any = ...,
             colors: Any = ..., material: Optional[str] = ...) -> None: ...
    def check(self) -> None: ...
    def close(self) -> None: ...
    def __enter__(self) -> Scene: ...
    def __exit__(self, kind: Optional[Type[BaseException]], value: Optional[BaseException],
                 trace: Optional[TracebackType]) -> None: ...

class Estimate:
    value: float
    low: float
    high: float
    at_most: float
    why: Optional[str]
    def __bool__(self) -> bool: ...
    def __float__(self) -> float: ...

class Render:
    def __init__(self, scene: Scene, *, size: Optional[Sequence[int]] = ..., aovs: Optional[Sequence[str]] = ...,
                 progress: _Progress = ..., **settings: Any) -> None: ...
    parts: List[Part]
    def step(self, samples: int = ..., *, seconds: float = ..., error: float = ...) -> bool: ...
    def checkpoint(self, path: _Path) -> None: ...
    def picture(self) -> Picture: ...
    def close(self) -> None: ...
    def __enter__(self) -> Render: ...
    def __exit__(self, kind: Optional[Type[BaseException]], value: Optional[BaseException],
                 trace: Optional[TracebackType]) -> None: ...

class Picture:
    render: Render
    size: Tuple[int, int]
    samples: int
    ended_by: str
    stopped: bool
    pixels_without_samples: int
    samples_dropped: int
    seconds: SimpleNamespace
    rays: SimpleNamespace
    error: Estimate
    hash: str
    repeat: Optional[str]
    channels: Dict[str, List[str]]
    layers: Dict[str, Pixels]
    array: Pixels
    __array_interface__: Dict[str, Any]
    def __getitem__(self, layer: str) -> Pixels: ...
    def save(self, path: _Path, *, half: bool = ...) -> None: ...
    def close(self) -> None: ...

def load(path: _Path, *, defines: Optional[Dict[str, Any]] = ..., allow_outside_paths: bool = ...,
         strict: bool = ..., context: Optional[Context] = ..., **more_defines: Any) -> Scene: ...
def render(scene: _SceneLike, *, context: Optional[Context] = ..., size: Optional[Sequence[int]] = ...,
           aovs: Optional[Sequence[str]] = ..., progress: _Progress = ..., **settings: Any) -> Picture: ...
def progressive(scene: _SceneLike, *, context: Optional[Context] = ..., spp: Optional[int] = ...,
                error: float = ..., seconds: float = ..., **settings: Any) -> Iterator[Picture]: ...
def read(path: _Path, layer: Optional[str] = ..., *, context: Optional[Context] = ...) -> Pixels: ...
def compare(picture: Any, reference: Any, *, context: Optional[Context] = ...) -> Metrics: ...
def devices(context: Optional[Context] = ...) -> List[Device]: ...
