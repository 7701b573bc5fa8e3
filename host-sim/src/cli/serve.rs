//! Arguments of a camera whose link is served.

use std::net::SocketAddr;

use clap::Args;

use super::DeviceArgs;

/// Arguments of `serve`.
#[derive(Debug, Args)]
pub struct ServeArgs {
    /// Device whose link is served.
    #[command(flatten)]
    pub device: DeviceArgs,
    /// Address and port on which others reach the camera. Port 0 is one of the system's choice.
    /// 0.0.0.0 in place of 127.0.0.1 lets other computers in, who may then command the camera.
    #[arg(long, value_name = "ADDRESS:PORT", default_value = "127.0.0.1:0", value_parser = address)]
    pub listen: SocketAddr,
}

fn address(text: &str) -> Result<SocketAddr, String> {
    text.parse().map_err(|_| {
        "not ADDRESS:PORT, such as 127.0.0.1:4000, 0.0.0.0:4000 or [::1]:4000 with a port of 0 to 65535"
            .to_owned()
    })
}
