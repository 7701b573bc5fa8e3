//! `serve`: the link of a camera on a port of this PC, for programs in other languages and on
//! other PCs.

use std::io::{self, ErrorKind, Write};
use std::net::{SocketAddr, TcpListener};
use std::time::{Duration, Instant};

use fmc_output::interruption::Interruption;

use crate::cli::ServeArgs;
use crate::device::port::{Port, TcpPort};
use crate::device::served::ServedCamera;
use crate::failure::{Failure, note};

/// Longest wait for bytes of either side before the other is looked at.
const TURN: Duration = Duration::from_millis(1);

/// The same while nobody is connected.
const IDLE: Duration = Duration::from_millis(20);

/// Bytes taken in one turn.
const BUFFER_BYTES: usize = 4096;

pub(super) fn run(args: &ServeArgs) -> Result<(), Failure> {
    // Whoever cannot be reached needs no camera.
    let listener = listen(args.listen)?;
    let mut camera = args.device.open_served()?;
    let address = listener
        .local_addr()
        .map_err(|error| refused(args.listen, &error))?;
    let interruption = Interruption::listen()
        .map_err(|error| Failure::device_or_io(format!("no signal can be caught: {error}")))?;
    let mut stdout = io::stdout().lock();
    writeln!(stdout, "tcp:{address}")
        .and_then(|()| stdout.flush())
        .map_err(|error| Failure::writing("standard output", &error))?;
    if !address.ip().is_loopback() {
        note(
            "note: whoever reaches this port may command the camera; 127.0.0.1 serves this computer alone",
        );
    }
    let mut client = None;
    while !interruption.is_asked() {
        accept(&listener, &mut client)?;
        exchange(&mut camera, &mut client)?;
    }
    Ok(())
}

fn listen(address: SocketAddr) -> Result<TcpListener, Failure> {
    let listener = TcpListener::bind(address).map_err(|error| refused(address, &error))?;
    let patient = listener.set_nonblocking(true);
    patient.map_err(|error| refused(address, &error))?;
    Ok(listener)
}

fn refused(address: SocketAddr, error: &io::Error) -> Failure {
    let why = match error.kind() {
        ErrorKind::AddrInUse => "another program has this port".to_owned(),
        ErrorKind::AddrNotAvailable => "this computer does not have this address".to_owned(),
        ErrorKind::PermissionDenied => "permission denied".to_owned(),
        _ => error.to_string(),
    };
    Failure::device_or_io(format!("--listen {address}: {why}"))
        .with_help("port 0 takes a free one, which is printed")
}

/// Takes a connection; while there is one, another is closed.
fn accept(listener: &TcpListener, client: &mut Option<TcpPort>) -> Result<(), Failure> {
    match listener.accept() {
        Ok((_, from)) if client.is_some() => {
            note(format_args!(
                "{from}: closed, as another program is connected"
            ));
        }
        Ok((stream, from)) => match TcpPort::new(stream) {
            Ok(port) => {
                note(format_args!("{from}: connected"));
                *client = Some(port);
            }
            Err(error) => note(format_args!("{from}: {error}")),
        },
        Err(error)
            if matches!(
                error.kind(),
                ErrorKind::WouldBlock | ErrorKind::Interrupted | ErrorKind::ConnectionAborted
            ) => {}
        Err(error) => {
            return Err(Failure::device_or_io(format!(
                "no connection can be taken: {error}"
            )));
        }
    }
    Ok(())
}

/// Passes on what has come from either side. A connection that ends leaves the camera as it is;
/// what the camera says while nobody is connected is not kept.
fn exchange(camera: &mut ServedCamera, client: &mut Option<TcpPort>) -> Result<(), Failure> {
    let mut buffer = [0; BUFFER_BYTES];
    if let Some(port) = client {
        match port.receive(&mut buffer, Instant::now() + TURN) {
            Ok(count) => {
                let bytes = buffer.get(..count).unwrap_or_default();
                let sent = camera.port().send(bytes);
                sent.map_err(|error| camera.explain(&error))?;
            }
            Err(_) => disconnect(client),
        }
    }
    let wait = if client.is_some() { TURN } else { IDLE };
    let received = camera.port().receive(&mut buffer, Instant::now() + wait);
    let count = received.map_err(|error| camera.explain(&error))?;
    let bytes = buffer.get(..count).unwrap_or_default();
    if let Some(port) = client
        && port.send(bytes).is_err()
    {
        disconnect(client);
    }
    Ok(())
}

fn disconnect(client: &mut Option<TcpPort>) {
    *client = None;
    note("disconnected");
}
